#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <volk.h>

namespace applique {

/// Where the compiled pipelines of a device are kept between runs; empty if there is no home to keep them in.
std::filesystem::path pipeline_cache_path(const VkPhysicalDeviceProperties& device);

/// The stored bytes; none if there are none, or if their header is not of this very device and driver.
std::vector<std::uint8_t> read_pipeline_cache(const std::filesystem::path& path,
                                              const VkPhysicalDeviceProperties& device);

/// Writes to a temporary file and renames it. A cache that cannot be written is no failure: it is left out.
void write_pipeline_cache(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes);

}  // namespace applique
