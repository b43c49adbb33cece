#pragma once

#include <optional>
#include <span>
#include <vector>

#include "applique/patch/immersed_disc.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// The patch to start from: shortest paths over the surface along the feature graph's tree, thickened (§2.3
/// of the design). The paper (§4.2, §4.3) fills the faces of the graph instead and asks the artist for more
/// features where their paths cross; a thickened tree is a disc for any features, so nobody is asked. Where
/// paths lie over one another the patch has several sheets (§4.2, Fig. 7).
struct Seed {
  ImmersedDisc disc;
  std::vector<PatchFaceId> feature_faces;  ///< The patch face over each feature, pinned.
  std::vector<std::vector<Vec3>> paths;    ///< By edge of the tree, from feature to feature, scene units.
  IdVector<PatchVertexId, Vec2> image;     ///< Where about in the image the vertices are (§4.3).
  std::uint32_t sheets = 1;                ///< How often a face may be covered at most.
  bool crossed = false;                    ///< Paths that are far apart in the image meet on the surface.
};

/// A feature as the seed sees it.
struct SeedFeature {
  SurfacePoint surface;  ///< On a face of the surface's mesh.
  Vec2 image;            ///< Plane units.
};

/// The feature graph's tree, but for edges whose shortest way over the surface leads another way than the
/// image does: round the back of a sphere, features far apart in the image are close. Such an edge is much
/// shorter than the others on the surface for its length in the image; others of the planar graph take its
/// place where they can. Not in the design.
std::vector<FeaturePair> faithful_tree(const SurfaceMesh& mesh, std::span<const SeedFeature> features,
                                       const FeatureGraph& graph);

/// What paths that cross on the surface are: parts of the image that lie over one another there, or of one
/// sheet all the same, whose features were moved past one another.
enum class Crossings { overlap, one_sheet };

/// `tree` spans the features. Paths that come near one another on the surface are one sheet, in which every
/// face is covered once, unless they are far apart in the image: then, with Crossings::overlap, each has a
/// sheet of its own there. Fails, naming a pair, when two features lie on parts that are not connected, or
/// when the way from one to the other is so crowded with others' that it has no triangles of its own.
struct SeedFailure {
  FeaturePair pair;
  bool crowded = false;
};
tl::expected<Seed, SeedFailure> build_seed(BridgedSurface& surface, std::span<const SeedFeature> features,
                                           std::span<const FeaturePair> tree,
                                           Crossings crossings = Crossings::overlap);

}  // namespace applique
