#pragma once

#include <filesystem>

#include "applique/base/error.h"

namespace applique::assets {

/// Writes what the gallery of the paper's figures needs besides the demo: the models of shapes.h, the images
/// of banners.cpp, and the jobs "gallery-*.json".
Result<void> write_gallery(const std::filesystem::path& folder);

}  // namespace applique::assets
