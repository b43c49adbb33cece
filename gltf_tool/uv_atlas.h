#pragma once

#include <array>
#include <optional>
#include <vector>

namespace applique {

/// A rectangle of an atlas, in whole units.
struct AtlasBox {
  int width = 0, height = 0;  ///< > 0.
  int x = 0, y = 0;           ///< Where it was put.
};

/// Puts the boxes side by side into a rectangle `width` wide (at least as wide as each), the tallest first,
/// each as far up as it goes over the skyline of those before it. Returns the height that they take.
int pack_boxes(std::vector<AtlasBox>& boxes, int width);

/// Packs boxes of units, each `fineness` texels long, into the smallest rectangle that this finds, of sides
/// that are powers of two, which mip pyramids and samplers like best, and at most `most`. Returns the sides,
/// in texels; none if there is none.
std::optional<std::array<int, 2>> pack_atlas(std::vector<AtlasBox>& boxes, int fineness, int most);

}  // namespace applique
