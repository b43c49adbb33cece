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

/// The pairs that a warp is made of: the visible ones, and for a feature that sees none its artificial ones.
/// Pairs of groups that do not meet move nothing and are left out.
std::vector<FeaturePair> warp_pairs(const FeatureGraph& graph, std::size_t features,
                                    const FeatureGroups& groups = {});

/// The warp that carries each point of `from` exactly to its partner in `to` (§3 of the design; §5.1.1 of the
/// paper, run backwards). Up to two features, or none that moves, need no warp once the embedding is aligned.
/// Features move straight, or where two would meet or nearly so, turning pieces of the graph rigidly in
/// between (§3.5 of the design); of warp_pairs(), those that nearly meet all the same are left out. `probes`
/// are places where the integration's step is tested. The points of `to` are distinct, and so are those of
/// `from` that share a group.
Warp build_warp(std::span<const Vec2> from, std::span<const Vec2> to, const FeatureGraph& graph,
                std::span<const WarpProbe> probes, const FeatureGroups& groups = {},
                const WarpOptions& options = {});

}  // namespace applique
