#pragma once

#include <span>
#include <vector>

#include "applique/patch/patch.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// A feature as the depths see it.
struct DepthFeature {
  Vec2 image;        ///< Plane units.
  PatchFaceId face;  ///< The patch face over it.
  double depth;      ///< Larger is on top.
};

/// A depth per patch face, for the order of those that lie over one surface face (§7 of the paper, §6.2 of
/// the design): the smoothest values, the sum of squared differences over neighbouring faces being least,
/// that take the features' depths at their faces and pass linearly from one to the next along the tree's
/// edges. The paper fixes the features' faces alone, whose grip on the rest is lost as the mesh is refined.
///
/// Where depths leave the order open, `order` settles it: the same with the features' numbers for depths, or
/// with a lone feature the place in the image.
struct FaceDepths {
  IdVector<PatchFaceId, double> depth;
  IdVector<PatchFaceId, double> order;
};
FaceDepths spread_depths(const Patch& patch, const IdVector<PatchVertexId, Vec2>& image,
                         std::span<const DepthFeature> features, std::span<const FeaturePair> tree);

}  // namespace applique
