#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "applique/region/feature_graph.h"
#include "applique/region/influence.h"

namespace applique {

/// Features that move the image together where it overlaps itself in the plane (§5.1.2 of the paper). One
/// group: everything moves everything.
struct FeatureGroups {
  std::uint32_t count = 1;
  std::vector<std::uint32_t> of;  ///< By feature; empty when there is one group.
  std::vector<char> meet;         ///< [a * count + b]: some place is under the influence of both.

  [[nodiscard]] bool joins(FeaturePair pair) const { return count == 1 || of[pair[0]] == of[pair[1]]; }
  [[nodiscard]] bool apart(FeaturePair pair) const {
    return count > 1 && meet[of[pair[0]] * count + of[pair[1]]] == 0;
  }
};

/// The groups of a field of influence, and which of them meet in it. `group` by feature, as the field has them.
FeatureGroups groups_of(const InfluenceField& field, std::vector<std::uint32_t> group);

/// Whether the planar graph does not stay planar when its features are where the embedding has them: two
/// edges without a common feature cross, or a triangle turns over (§3.6 of the design). The image then has to
/// lie over itself in the plane.
bool graph_overlaps(std::span<const Vec2> features, const FeatureGraph& graph);

/// Cuts every group that has to lie over itself into runs of two or a few features along the tree: clusters
/// come from what sees what in the image, and in a straight ribbon, say, everything does. `group` by feature,
/// numbered from 0; the result too. With `all`, every group is cut. A feature that the tree joins to none of
/// its group keeps its group.
std::vector<std::uint32_t> cut_overlapping_groups(std::vector<std::uint32_t> group,
                                                  std::span<const Vec2> features, const FeatureGraph& graph,
                                                  bool all);

}  // namespace applique
