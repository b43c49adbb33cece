#pragma once

#include <filesystem>

#include "applique/gpu/device.h"

#include "compare/comparison.h"

namespace applique::compare {

/// The cases that the page shows pictures of.
bool is_pictured(const CaseName& name);

/// Writes table.csv, table.md and index.html with pictures/*.png into the folder, which it makes, and for
/// each pictured case a sheet of all methods, in the order of the rows ("bump-star-5.png"). Without a device
/// the page shows the texture coordinates alone. Errors: output_unwritable, device_failed.
Result<void> write_page(const std::filesystem::path& folder, const Comparison& comparison,
                        const std::vector<SiteSource>& sources, const Device* device);

}  // namespace applique::compare
