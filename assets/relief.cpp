#include <algorithm>
#include <cmath>
#include <vector>

#include "images.h"

namespace applique::assets {
namespace {

/// A height for each pixel.
struct Heights {
  int width, height;
  std::vector<double> at;

  [[nodiscard]] double operator()(int x, int y) const {
    return at[static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * width + std::clamp(x, 0, width - 1)];
  }
};

/// The mean over the pixels up to `radius` away, along rows or down columns.
Heights blurred(const Heights& heights, int radius, bool rows) {
  Heights out = heights;
  for (int y = 0; y < heights.height; ++y)
    for (int x = 0; x < heights.width; ++x) {
      double sum = 0;
      for (int k = -radius; k <= radius; ++k) sum += rows ? heights(x + k, y) : heights(x, y + k);
      out.at[static_cast<std::size_t>(y) * heights.width + x] = sum / (2 * radius + 1);
    }
  return out;
}

/// Twice in both directions: a smooth slope of four radii.
Heights smoothed(Heights heights, int radius) {
  for (int pass = 0; pass < 2; ++pass) heights = blurred(blurred(heights, radius, true), radius, false);
  return heights;
}

}  // namespace

Image draw_relief(const Image& painting) {
  constexpr double plate = 5, paint = 2.5;  // pixels high
  Heights outline{painting.width, painting.height, {}}, colours = outline;
  for (std::size_t i = 0; i < painting.rgba.size(); i += 4) {
    const std::uint16_t* p = &painting.rgba[i];
    const double alpha = p[3] / 65535.0;
    outline.at.push_back(alpha);
    colours.at.push_back(alpha * (0.3 * p[0] + 0.59 * p[1] + 0.11 * p[2]) / 65535.0);
  }
  outline = smoothed(outline, 4);
  colours = smoothed(colours, 1);
  const auto height = [&](int x, int y) { return plate * outline(x, y) + paint * colours(x, y); };

  Image normals = make_image(painting.width, painting.height, {});
  normals.channels = 3;
  for (int y = 0; y < painting.height; ++y)
    for (int x = 0; x < painting.width; ++x) {
      // Normal maps have y up, images down.
      const Vec3 normal =
          Vec3(0.5 * (height(x - 1, y) - height(x + 1, y)), 0.5 * (height(x, y + 1) - height(x, y - 1)), 1)
              .normalized();
      for (int c = 0; c < 3; ++c)
        normals.pixel(x, y)[c] = static_cast<std::uint16_t>(257 * std::lround(127.5 + 127.5 * normal[c]));
      normals.pixel(x, y)[3] = 65535;
    }
  return normals;
}

}  // namespace applique::assets
