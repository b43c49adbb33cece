#pragma once

#include <filesystem>

#include "applique/base/error.h"

namespace applique::assets {

/// Writes bust-mask.json, bust-emblem.json and bottle-label.json, which pin mask.png, emblem.png and
/// label.png to bust.glb and bottle.glb in the same folder.
Result<void> write_jobs(const std::filesystem::path& folder);

}  // namespace applique::assets
