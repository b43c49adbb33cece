#pragma once

#include <span>
#include <vector>

#include "applique/region/feature_graph.h"

namespace applique {

/// Where the features are at equally spaced times from 0 to 1, linear in between: [keyframe][feature]. Two
/// keyframes (straight lines) when no pair comes much closer on the way than at its ends; otherwise 9 or more
/// that turn and scale the edges of the graph evenly, so that features do not run into one another (fixes
/// §5.1.3 case 1 of the paper; §3.5 of the design). The ends are `from` and `to` exactly.
std::vector<std::vector<Vec2>> feature_trajectories(std::span<const Vec2> from, std::span<const Vec2> to,
                                                    const FeatureGraph& graph,
                                                    std::span<const FeaturePair> pairs);

/// The least length of the pair's segment on the way, relative to the shorter of its ends.
double closest_approach(const std::vector<std::vector<Vec2>>& keyframes, FeaturePair pair);

}  // namespace applique
