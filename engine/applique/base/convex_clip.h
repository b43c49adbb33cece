#pragma once

#include <cstddef>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// Sutherland and Hodgman: the part of a convex polygon whose corners `depth` does not find negative; it is
/// linear, and mix(from, to, t) gives the place t of the way along an edge.
template <class Place, class Depth, class Mix>
std::vector<Place> clip_convex(const std::vector<Place>& polygon, const Depth& depth, const Mix& mix) {
  std::vector<Place> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Place &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double before = depth(from), after = depth(to);
    if (before >= 0) kept.push_back(from);
    if ((before < 0) != (after < 0)) kept.push_back(mix(from, to, before / (before - after)));
  }
  return kept;
}

/// The part of the polygon to the left of a -> b.
inline std::vector<Vec2> clip_left_of(const std::vector<Vec2>& polygon, Vec2 a, Vec2 b) {
  return clip_convex(
      polygon, [&](Vec2 z) { return cross(b - a, z - a); },
      [](Vec2 from, Vec2 to, double t) { return from + t * (to - from); });
}

}  // namespace applique
