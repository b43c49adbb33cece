#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/feature_graph.h"
#include "applique/region/region.h"

namespace applique {

/// By feature, the number of its group: the features that move one part of the region, where parts of it may
/// come to lie over each other (§5.1.2 and Fig. 13 of the paper, §3.6 of the design). Groups are numbered by
/// their lowest feature; renumbering the features does not change them.
///
/// As in the paper, the triangle of the region's constrained Delaunay triangulation that most visible
/// segments cross makes the features at their ends a group, again and again. Beyond the paper, ties are
/// decided, a feature without a partner that it sees in its own group joins the nearest one's (artificial
/// pairs count for features that see none), and groups whose features all see each other are one: the hull of
/// those lies in the region, so that no part of it could slide over another. Hence a convex region has one
/// group.
std::vector<std::uint32_t> cluster_features(const Region& region, std::span<const Vec2> features,
                                            const FeatureGraph& graph);

}  // namespace applique
