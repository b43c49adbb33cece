#pragma once

#include <cstddef>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// Sutherland and Hodgman: the part of the polygon to the left of a -> b.
inline std::vector<Vec2> clip_left_of(const std::vector<Vec2>& polygon, Vec2 a, Vec2 b) {
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 from = polygon[i], to = polygon[(i + 1) % polygon.size()];
    const double before = cross(b - a, from - a), after = cross(b - a, to - a);
    if (before >= 0) kept.push_back(from);
    if ((before < 0) != (after < 0)) kept.push_back(from + before / (before - after) * (to - from));
  }
  return kept;
}

}  // namespace applique
