#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/region.h"

namespace applique {

/// Two features, by index, first < second.
using FeaturePair = std::array<std::uint32_t, 2>;

/// The features in the image and which of them see each other inside the region (§4.1 of the paper, §2.2 and
/// §3.4 of the design). All lists are sorted.
struct FeatureGraph {
  std::vector<FeaturePair> visible;  ///< Pairs whose segment lies in the region: the warp's pairs.
  std::vector<FeaturePair>
      artificial;  ///< Pairs added to join what sees nothing: shortest way inside the region.
  std::vector<FeaturePair> planar;  ///< Non-crossing visible segments, shortest first, Delaunay flipped.
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< Triangles of `planar`, counter-clockwise in the plane.
  std::vector<FeaturePair>
      tree;  ///< Minimum spanning tree over visible and artificial pairs: the seed's paths.
};

/// `features` lie in the closed region, pairwise distinct.
FeatureGraph build_feature_graph(const Region& region, const std::vector<Vec2>& features);

}  // namespace applique
