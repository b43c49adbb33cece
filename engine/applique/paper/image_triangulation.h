#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/region.h"

namespace applique {

/// The image region as triangles (§5.1.2 and §5.2.1 of the paper), with given points among theirs.
struct ImageTriangulation {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<Vec2> points;                              ///< Plane units.
  std::vector<std::array<std::uint32_t, 3>> triangles;   ///< Counter-clockwise.
  std::vector<std::array<std::uint32_t, 3>> neighbours;  ///< Across the edge opposite corner k, or `none`.
  std::vector<std::uint32_t> features;                   ///< The number of each given point.
};

/// The constrained Delaunay triangulation of the contour and the features, and then, so that the warp can
/// bend it, its longest edges bisected (Rivara 1984) until none is longer than `longest_edge`, plane units.
/// Quadratic in the contour's vertices at worst.
ImageTriangulation triangulate_image(const Region& region, const std::vector<Vec2>& features,
                                     double longest_edge = std::numeric_limits<double>::infinity());

}  // namespace applique
