#pragma once

#include <vector>

#include "applique/base/ids.h"
#include "applique/base/types.h"
#include "applique/patch/patch.h"

namespace applique {

/// What a solve went through, kept when SolveOptions::trace asks for it: for pictures of the method and for
/// tests.
struct SolveTrace {
  /// The patch after one embedding, before it is peeled and grown.
  struct Step {
    Patch patch;
    IdVector<PatchVertexId, Vec2> plane;   ///< The aligned embedding.
    IdVector<PatchVertexId, Vec2> image;   ///< Where the warp puts the vertices in the image, plane units.
    IdVector<PatchVertexId, char> inside;  ///< The set S of §5.2.1 of the paper.
    std::vector<Vec2> features;            ///< Where the features are in the plane.
    std::vector<Vec2> contour;  ///< The region's contour carried into the plane, its edges divided.
    double lambda = 1;  ///< Paper's method: less than 1 where it rolled back, the share of the way it took.
  };
  /// From feature to feature along the surface, scene units: one for each edge of FeatureGraph::tree, or, in
  /// the paper's method, of its own graph.
  std::vector<std::vector<Vec3>> paths;
  std::vector<Step> steps;  ///< steps[0] is the seed.
};

}  // namespace applique
