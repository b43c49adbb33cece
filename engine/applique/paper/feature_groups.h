#pragma once

#include <cstdint>
#include <vector>

#include "applique/paper/image_triangulation.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// Features in groups, each with an area of influence, so that parts of the region may overlap (§5.1.2 of the
/// paper, Fig. 13).
struct FeatureGroups {
  std::uint32_t count = 1;
  std::vector<std::uint32_t> group;  ///< By feature.
};

/// Of the constrained Delaunay triangulation, the triangle that most segments between features cross, as long
/// as they have a feature without a group: these features are a new group; and so on. A segment crosses a
/// triangle when they share more than a point. Ties go to the larger triangle, then to the lower number.
FeatureGroups group_features(const Region& region, const std::vector<Vec2>& features,
                             const FeatureGraph& graph);

/// A triangulation of the region that the influence is defined on.
struct InfluenceArea {
  ImageTriangulation triangulation;
  std::vector<double> influence;  ///< alpha_{p,l}: [point * groups + group]; each point's sum to 1.
};

/// Minimises the energy of §5.1.2 over the edges of a triangulation with edges of at most `longest_edge`. The
/// paper fixes the values at the features alone; in a fine triangulation single points hold nothing (E8 of
/// the design), so here also on the edges of the planar graph that join features of one group.
InfluenceArea spread_influence(const Region& region, const std::vector<Vec2>& features,
                               const FeatureGraph& graph, const FeatureGroups& groups, double longest_edge);

}  // namespace applique
