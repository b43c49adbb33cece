#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/region.h"

namespace applique {

/// A triangulation of the region with the features among its points.
struct RegionTriangulation {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<Vec2> points;                              ///< Plane units.
  std::vector<std::array<std::uint32_t, 3>> triangles;   ///< Counter-clockwise.
  std::vector<std::array<std::uint32_t, 3>> neighbours;  ///< Across the edge opposite corner k, or `none`.
  std::vector<std::uint32_t> features;                   ///< By feature, its point.
};

/// Ears of the contour, the features put in, flipped to constrained Delaunay, longest edges bisected until
/// none is longer than 1/40 of the region's diameter.
RegionTriangulation triangulate_region(const Region& region, const std::vector<Vec2>& features);

}  // namespace applique
