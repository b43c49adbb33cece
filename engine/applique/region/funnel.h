#pragma once

#include <cstddef>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// An edge of a sleeve of triangles, as the path walks through it.
struct Portal {
  Vec2 left, right;
};

/// A corner that the path is pulled tight round.
struct FunnelTurn {
  Vec2 at;
  std::size_t portal;  ///< The last portal before the turn that has this corner.
  bool left;           ///< The corner is on the path's left, so that the path turns left.
};

/// The turns of the shortest path from `a` to `b` through the portals, in order (the funnel of Lee and
/// Preparata 1984); none when the straight line passes.
std::vector<FunnelTurn> pull_tight(Vec2 a, Vec2 b, const std::vector<Portal>& portals);

}  // namespace applique
