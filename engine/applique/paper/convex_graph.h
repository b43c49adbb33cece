#pragma once

#include <cstdint>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// The feature-point graph G_I of §4.1 of the paper (Fig. 3): the triangulation of the features with its
/// inner edges deleted, and its concave faces cut into convex ones.
struct ConvexGraph {
  std::vector<FeaturePair> edges;                 ///< Outlines, cuts and bridges, sorted.
  std::vector<FeaturePair> bridges;               ///< Those on no face, sorted.
  std::vector<std::vector<std::uint32_t>> faces;  ///< Convex, each counter-clockwise.
  /// A feature that the deletion left without an edge, and the face that it lies in.
  struct Isolated {
    std::uint32_t feature;
    std::uint32_t face;
  };
  std::vector<Isolated> isolated;
};

/// `graph` is that of `features`. The paper does not say how concave faces are cut; here as Hertel and
/// Mehlhorn 1983 do: triangulate, shortest diagonals first, then drop the longest that no corner needs to be
/// convex. At most four times the least number of faces; O(n^3) in the corners of an outline.
ConvexGraph build_convex_graph(const std::vector<Vec2>& features, const FeatureGraph& graph);

}  // namespace applique
