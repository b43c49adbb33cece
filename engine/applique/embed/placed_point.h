#pragma once

#include <array>

#include "applique/base/types.h"

namespace applique {

/// A place in a triangle that is to lie at `target`.
struct PlacedPoint {
  std::array<int, 3> corners;         ///< Vertices.
  std::array<double, 3> barycentric;  ///< Sum 1.
  Vec2 target;
};

}  // namespace applique
