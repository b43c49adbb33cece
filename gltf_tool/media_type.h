#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace applique {

/// The media type of an image that glTF and its extensions know, by its first bytes: "image/png",
/// "image/jpeg", "image/webp" or "image/ktx2"; "" for another.
std::string media_type_of(std::span<const std::uint8_t> bytes);

/// The ending of file names of a media type: ".png"; "" for another than those above.
std::string extension_of(const std::string& media_type);

}  // namespace applique
