#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "applique/image/image.h"

namespace applique {

/// Reads WebP bytes, lossy or lossless, alpha straight as stored (OpenImageIO's reader multiplies it in).
/// `name` stands for the file in errors (image_invalid; also for animations).
Result<Image> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name);

/// Refuses sizes that no texture or picture comes near. Errors: image_invalid.
Result<void> check_image_size(std::int64_t width, std::int64_t height, const std::string& name);

}  // namespace applique
