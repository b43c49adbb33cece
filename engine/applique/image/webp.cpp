#include "applique/image/webp.h"

#include <fmt/format.h>
#include <webp/decode.h>
#include <webp/encode.h>

namespace applique {
namespace {

constexpr int lossless_quality = 100;
constexpr int lossless_effort = 20;  // of 100; more takes longer and saves little
constexpr int lossy_method = 4;      // of 6, as libwebp's own default

/// WebP wants 32-bit pixels, alpha on top.
std::vector<std::uint32_t> to_argb(const Image& image) {
  std::vector<std::uint32_t> pixels(image.rgba.size() / 4);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::uint16_t* p = &image.rgba[4 * i];
    const auto alpha = image.has_alpha() ? to_8_bits(p[3]) : std::uint8_t{255};
    pixels[i] = static_cast<std::uint32_t>(alpha) << 24 | to_8_bits(p[0]) << 16 | to_8_bits(p[1]) << 8 |
                to_8_bits(p[2]);
  }
  return pixels;
}

/// A picture and what was written of it, released together.
struct Encoder {
  WebPPicture picture;
  WebPMemoryWriter writer;

  Encoder() {
    WebPPictureInit(&picture);
    WebPMemoryWriterInit(&writer);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
  }
  ~Encoder() {
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&writer);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
};

}  // namespace

Result<Image> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name) {
  const auto invalid = [&](const std::string& reason) {
    return fail(ErrorCode::image_invalid, fmt::format("image '{}': {}", name, reason));
  };
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
    return invalid("not a whole WebP file");
  if (features.has_animation != 0) return invalid("an animated WebP cannot be read; save one picture of it");
  APPLIQUE_CHECK(check_image_size(features.width, features.height, name));
  std::vector<std::uint8_t> stored(4 * static_cast<std::size_t>(features.width) * features.height);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), stored.data(), stored.size(), 4 * features.width) ==
      nullptr)
    return invalid("its WebP data are broken or cut off");
  Image image;
  image.width = features.width;
  image.height = features.height;
  image.channels = features.has_alpha != 0 ? 4 : 3;
  image.rgba.resize(stored.size());
  for (std::size_t i = 0; i < stored.size(); ++i) image.rgba[i] = static_cast<std::uint16_t>(257 * stored[i]);
  return image;
}

Result<std::vector<std::uint8_t>> encode_webp(const Image& image, int quality) {
  APPLIQUE_ASSERT(image.rgba.size() == 4 * static_cast<std::size_t>(image.width) * image.height);
  const auto failed = [](const std::string& reason) {
    return fail(ErrorCode::output_unwritable, fmt::format("WebP cannot be encoded: {}", reason));
  };
  if (image.width > webp_largest_side || image.height > webp_largest_side)
    return failed(fmt::format("{} x {} pixels, at most {} a side are allowed", image.width, image.height,
                              webp_largest_side));
  WebPConfig config;
  WebPConfigInit(&config);
  const bool lossless = quality == lossless_quality;
  config.lossless = lossless ? 1 : 0;
  config.quality = static_cast<float>(lossless ? lossless_effort : quality);
  config.method = lossless ? 2 : lossy_method;
  config.exact = 1;  // Colours under transparency are filtered at the edge of what is opaque.
  config.use_sharp_yuv = 1;
  config.thread_level = 1;
  std::vector<std::uint32_t> pixels = to_argb(image);
  Encoder encoder;
  encoder.picture.use_argb = 1;
  encoder.picture.width = image.width;
  encoder.picture.height = image.height;
  encoder.picture.argb = pixels.data();
  encoder.picture.argb_stride = image.width;
  if (WebPValidateConfig(&config) == 0 || WebPEncode(&config, &encoder.picture) == 0)
    return failed(fmt::format("libwebp's error {}", static_cast<int>(encoder.picture.error_code)));
  return std::vector<std::uint8_t>(encoder.writer.mem, encoder.writer.mem + encoder.writer.size);
}

}  // namespace applique
