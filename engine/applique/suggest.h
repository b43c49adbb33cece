#pragma once

#include <cstddef>
#include <optional>

#include "applique/decal.h"

namespace applique {

struct SuggestOptions {
  SolveOptions solve;         ///< As the decal was solved; the trace is not written to.
  std::size_t places = 12;    ///< Places of the image where a further feature is tried out.
  std::size_t gains = 3;      ///< Solved in full, the most promising first, until so many are gains.
  double least_gain = 0.001;  ///< Share of the L2 stretch that a change has to take off.
};

/// What would lower a decal's L2 stretch most. Each `l2_stretch` is that of a full solution of the changed
/// input, which covers as much of the region as before and turns over no more faces.
struct Suggestion {
  struct Added {
    Feature feature;  ///< Its image point on tenths of a pixel, its surface point the nearest to `position`.
    Vec3 position;    ///< In scene units, to six digits or so of the decal's size: to be written down.
    double l2_stretch;
  };
  struct LeftOut {
    std::size_t feature;  ///< Its index.
    double l2_stretch;
  };
  double l2_stretch = 1;     ///< Of the decal as it is, normalised.
  std::optional<Added> add;  ///< None if no further feature helps, or the method has no warp to relax.
  std::optional<LeftOut> leave_out;  ///< None if the features are best together.
};

/// Looks for the further feature, and for the one too many, that lower the stretch most. `map` solves
/// `input`.
///
/// A feature at the present correspondence would change nothing: it has to hold the image where the map is at
/// ease. So a place of the image amid much stretch, far from the features, is pinned to surface points around
/// the one it is on, down the stretch: a compass search in the plane on the patch as it is, for which only
/// the warp is built anew (some milliseconds a try). The best are then solved in full.
Suggestion suggest_feature(const SurfaceMesh& surface, const DecalInput& input, const DecalMap& map,
                           const SuggestOptions& options = {});

}  // namespace applique
