#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "applique/base/types.h"
#include "applique/patch/immersed_disc.h"

namespace applique {

/// The intrinsic geometry of a triangulated disc: all that an embedding needs to know of it.
struct DiscGeometry {
  std::size_t vertices = 0;
  std::vector<std::array<int, 3>> faces;          ///< Counter-clockwise.
  std::vector<std::array<double, 3>> lengths;     ///< Of the edge opposite corner k; mollified.
  std::vector<std::array<double, 3>> cotangents;  ///< Of the angle at corner k.
  std::vector<int> boundary;                      ///< The boundary's vertices, counter-clockwise.
  double area = 0;

  /// Triangle t laid in the plane: corner 0 at the origin, corner 1 on the positive x axis.
  [[nodiscard]] std::array<Vec2, 3> flat(std::size_t t) const;
  [[nodiscard]] double angle(std::size_t t, int k) const;
};

/// Measures a disc whose ids are compact. Lengths are mollified (Sharp and Crane 2020): a common amount is
/// added to all edges so that every triangle keeps a proper shape; it is zero unless triangles are
/// degenerate.
DiscGeometry measure_disc(const ImmersedDisc& disc);

/// Number of triangles that `plane` turns over or collapses, by the exact orientation predicate.
std::size_t count_flips(const DiscGeometry& disc, const std::vector<Vec2>& plane);

}  // namespace applique
