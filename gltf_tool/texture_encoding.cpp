#include "texture_encoding.h"

#include <algorithm>

#include <fmt/format.h>

namespace applique {
namespace {

Result<std::vector<std::uint8_t>> encode(const Image& texture, const TextureEncoding& encoding) {
  switch (encoding.format) {
    case TextureFormat::jpeg:
      return encode_jpeg(texture, encoding.quality);
    case TextureFormat::webp:
      return encode_webp(texture, encoding.quality);
    case TextureFormat::png:
      break;
  }
  if (!encoding.bits || *encoding.bits == texture.bits) return encode_png(texture);
  Image converted = texture;
  converted.bits = *encoding.bits;
  return encode_png(converted);
}

std::string why_not(const Image& texture, TextureFormat format) {
  if (format == TextureFormat::jpeg && has_transparency(texture)) return "JPEG has no transparency";
  if (format == TextureFormat::webp && std::max(texture.width, texture.height) > webp_largest_side)
    return fmt::format("WebP has at most {} texels a side", webp_largest_side);
  return "";
}

}  // namespace

const char* name_of(TextureFormat format) {
  switch (format) {
    case TextureFormat::jpeg:
      return "jpeg";
    case TextureFormat::webp:
      return "webp";
    case TextureFormat::png:
      break;
  }
  return "png";
}

int working_bits(const TextureEncoding& encoding, int bits) {
  return encoding.format == TextureFormat::png ? std::max(bits, encoding.bits.value_or(bits)) : bits;
}

Warning png_warning(const std::string& texture, const EncodedTexture& encoded) {
  return {"texture_is_png", fmt::format("{} is stored as a PNG: {}", texture, encoded.why_png)};
}

Result<EncodedTexture> encode_texture(const Image& texture, const TextureEncoding& encoding) {
  EncodedTexture encoded;
  encoded.why_png = why_not(texture, encoding.format);
  TextureEncoding possible = encoding;
  if (!encoded.why_png.empty()) possible.format = TextureFormat::png;
  encoded.format = possible.format;
  APPLIQUE_TRY(encoded.bytes, encode(texture, possible));
  return encoded;
}

}  // namespace applique
