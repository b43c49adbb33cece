#pragma once

#include <cstdint>
#include <vector>

#include "applique/image/image.h"

namespace applique {

/// A yes or no for each pixel of an image, with a border of one "no" pixel all round.
struct AlphaMask {
  int width = 0;  ///< With the border: pixel (x, y) of the image is (x + 1, y + 1) here.
  int height = 0;
  std::vector<std::uint8_t> bits;

  [[nodiscard]] std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  [[nodiscard]] bool has(int x, int y) const { return bits[index(x, y)] != 0; }
};

/// The pixels whose alpha (0..1) is over `threshold`.
AlphaMask make_alpha_mask(const Image& image, double threshold);

/// Sets what the outside does not reach over pixel sides.
void fill_holes(AlphaMask& mask);

/// Joins its islands (pixels that touch at sides or corners; without holes) by lines of pixels: shortest
/// first, until all are one (the minimum spanning tree over neighbouring islands). What that encloses is
/// filled.
void bridge_islands(AlphaMask& mask);

}  // namespace applique
