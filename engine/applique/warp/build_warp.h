#pragma once

#include <span>
#include <vector>

#include "applique/region/feature_graph.h"
#include "applique/warp/groups.h"
#include "applique/warp/warp.h"

namespace applique {

struct WarpOptions {
  double tolerance =
      2e-5;  ///< Of the integration, plane units: the step is halved while the result moves more.
  std::uint32_t max_steps = 64;
};

/// A place where a warp is tried out.
struct WarpProbe {
  Vec2 plane;
  std::vector<double> influence;  ///< By group; not looked at when there is one.
};

/// What a pair of features asks of the warp.
struct PairStress {
  FeaturePair pair;
  double scale;  ///< Length in the image over length in the plane.
  double turn;   ///< Radians, in (-pi, pi].
};

struct BuiltWarp {
  Warp warp;
  std::vector<PairStress> stressed;  ///< Pairs scaled by more than 4 or turned by more than 120 degrees.
};

/// The warp that carries each point of `from` exactly to its partner in `to` (§3 of the design; §5.1.1 of the
/// paper, run backwards). Up to two features, or none that moves, need no warp once the embedding is aligned.
/// Features move straight, or where two would meet or nearly so, turning pieces of the graph rigidly in
/// between (§3.5 of the design). `probes` are places where the integration's step is tested. The points of
/// `to` are distinct, and so are those of `from` that share a group. Pairs of groups that do not meet are
/// left out.
BuiltWarp build_warp(std::span<const Vec2> from, std::span<const Vec2> to, const FeatureGraph& graph,
                     std::span<const WarpProbe> probes, const FeatureGroups& groups = {},
                     const WarpOptions& options = {});

}  // namespace applique
