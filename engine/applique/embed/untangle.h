#pragma once

#include <array>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/embed/placed_point.h"

namespace applique {

/// A triangulation whose map to the plane turns triangles over.
struct Tangle {
  std::vector<std::array<int, 3>> faces;  ///< Counter-clockwise.
  std::vector<std::array<Vec2, 3>>
      rest;                 ///< By face: its shape at rest, counter-clockwise, of the plane's own scale.
  std::vector<char> fixed;  ///< By vertex: it stays where it is.
  std::vector<PlacedPoint> placed;  ///< Each has a vertex that is not fixed.
};

struct UntangleOptions {
  int max_rounds = 40;  ///< Of regularisation, each of up to 40 steps.
};

struct Untangled {
  std::vector<Vec2> plane;
  std::size_t flips = 0;  ///< Triangles that are turned over all the same, by the exact predicate.
};

/// Moves the vertices until no triangle is turned over, while the placed points lie at their targets at every
/// step: the regularised energy of foldover-free maps (Garanzha et al. 2021; §4.3 of the design) by L-BFGS
/// over a Laplacian whose steps keep to the placed points. Goes on for a little after the last triangle has
/// come round, so that none is left just short of collapse. Ends when the energy does not fall any more; then
/// flips are left.
Untangled untangle(const Tangle& tangle, std::vector<Vec2> plane, const UntangleOptions& options = {});

}  // namespace applique
