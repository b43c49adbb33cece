#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "applique/base/error.h"

namespace applique {

/// An image in memory: RGBA with straight alpha, values as stored (colour is sRGB-encoded), row by row from
/// the top. Every channel has 16 bits; what came from 8 bits is held times 257, so that it goes back
/// unchanged.
struct Image {
  int width = 0;   ///< Pixels.
  int height = 0;  ///< Pixels.
  int channels =
      4;         ///< Channels of the file: 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA. Missing alpha is opaque.
  int bits = 8;  ///< Bits a channel in the file: 8 or 16.
  std::vector<std::uint16_t> rgba;  ///< 4 * width * height.

  [[nodiscard]] bool has_alpha() const { return channels == 2 || channels == 4; }
  [[nodiscard]] const std::uint16_t* pixel(int x, int y) const {
    return &rgba[4 * (static_cast<std::size_t>(y) * width + x)];
  }
  std::uint16_t* pixel(int x, int y) { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
};

/// An image of one colour (16-bit RGBA), 4 channels of 8 bits.
Image make_image(int width, int height, std::array<std::uint16_t, 4> colour);

/// What floating-point values of a file are: light, which becomes sRGB-encoded, or numbers from 0 to 1 (the
/// roughness, a mask), which stay.
enum class Floats { light, data };

/// Whether some pixel is not opaque.
bool has_transparency(const Image& image);

/// Reads WebP and any format that OpenImageIO knows (PNG with palettes, JPEG, TIFF, OpenEXR, Radiance HDR,
/// …). Floating-point values are taken as image_of_floats says (float_image.h). Errors: file_unreadable,
/// image_invalid (with the decoder's reason).
Result<Image> read_image(const std::filesystem::path& path, Floats floats = Floats::light);

/// The same from bytes in memory; `name` stands for the file in errors.
Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& name,
                           Floats floats = Floats::light);

/// Width and height of an image in memory, without its pixels. Errors: as decode_image's, of its header.
Result<std::array<int, 2>> image_size(std::span<const std::uint8_t> bytes, const std::string& name);

/// PNG bytes with the image's own channels and bits.
Result<std::vector<std::uint8_t>> encode_png(const Image& image);

/// JPEG bytes, without alpha, colours at full resolution; `quality` from 1 to 100. Errors: output_unwritable.
Result<std::vector<std::uint8_t>> encode_jpeg(const Image& image, int quality);

/// WebP bytes, with the colours under transparency; `quality` from 1 to 100, which is lossless. Errors:
/// output_unwritable, for a side of more than webp_largest_side too.
Result<std::vector<std::uint8_t>> encode_webp(const Image& image, int quality);
inline constexpr int webp_largest_side = 16383;

/// The nearest of 8 bits to a channel's 16; exact for what came from 8.
inline std::uint8_t to_8_bits(std::uint16_t value) {
  return static_cast<std::uint8_t>((value + 128U) / 257U);
}

}  // namespace applique
