#pragma once

#include <array>
#include <string>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/region.h"

namespace applique::compare {

constexpr int image_size = 512;                              // pixels, width and height
constexpr double disc_radius = 240;                          // pixels
constexpr double disc_share = 2 * disc_radius / image_size;  // of the image's width

/// A region of the image and the pins in it. Fewer pins are the first ones: the first is in the middle, which
/// every method meets.
struct Layout {
  std::string name;
  Region region;
  std::array<Pixel, 9> pins;
};

constexpr std::array<int, 4> pin_counts = {1, 2, 5, 9};

/// A disc; a star of five points; a strip, whose pins are all on its axis.
std::vector<Layout> all_layouts();

}  // namespace applique::compare
