#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "applique/base/error.h"
#include "applique/image/image.h"

namespace applique {

enum class TextureFormat { png, jpeg, webp };

/// How a bake stores the textures that it writes.
struct TextureEncoding {
  TextureFormat format = TextureFormat::png;
  int quality = 90;         ///< Of JPEG and WebP, 1 to 100; 100 makes WebP lossless.
  std::optional<int> bits;  ///< Of PNG, 8 or 16 a channel; none: as the texture had before.
};

struct EncodedTexture {
  std::vector<std::uint8_t> bytes;
  TextureFormat format = TextureFormat::png;
  std::string why_png;  ///< Why it could not have the wanted format; "" if it has.
};

/// As jobs, options and reports call it: "png".
const char* name_of(TextureFormat format);

/// The bits a channel that a texture of `bits` is to be worked on with, so that it is rounded once.
int working_bits(const TextureEncoding& encoding, int bits);

/// The texture as it is stored. What the wanted format cannot hold becomes a PNG: transparency as JPEG, a
/// side of more than 16383 texels as WebP. Errors: output_unwritable.
Result<EncodedTexture> encode_texture(const Image& texture, const TextureEncoding& encoding);

/// Tells that a texture ("the baseColor texture of 'skin'") is not stored in the wanted format.
Warning png_warning(const std::string& texture, const EncodedTexture& encoded);

}  // namespace applique
