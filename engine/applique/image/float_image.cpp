#include "applique/image/float_image.h"

#include <algorithm>
#include <cmath>

#include "applique/base/parallel.h"
#include "applique/image/decal_image.h"

namespace applique {
namespace {

std::uint16_t to_16_bits(double value) {
  return static_cast<std::uint16_t>(std::lround(value * 0xffff));
}

/// To [0, 1]; no number becomes 0.
double share(double value) {
  return value > 0 ? std::min(value, 1.0) : 0;
}

}  // namespace

Image image_of_floats(int width, int height, int channels, std::span<const float> values, Floats floats) {
  APPLIQUE_ASSERT(values.size() == static_cast<std::size_t>(width) * height * channels);
  Image image;
  image.width = width;
  image.height = height;
  image.channels = channels;
  image.bits = 16;
  image.rgba.resize(4 * static_cast<std::size_t>(width) * height);
  const bool grey = channels < 3;
  parallel_ranges(image.rgba.size() / 4, 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const float* in = &values[i * static_cast<std::size_t>(channels)];
      std::uint16_t* out = &image.rgba[4 * i];
      const double alpha = image.has_alpha() ? share(in[channels - 1]) : 1;
      for (int k = 0; k < 3; ++k) {
        const double premultiplied = in[grey ? 0 : k];
        const double value = share(alpha > 0 ? premultiplied / alpha : premultiplied);
        out[k] = to_16_bits(floats == Floats::light ? linear_to_srgb(value) : value);
      }
      out[3] = to_16_bits(alpha);
    }
  });
  return image;
}

}  // namespace applique
