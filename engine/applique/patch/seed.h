#pragma once

#include <optional>
#include <span>
#include <vector>

#include "applique/patch/immersed_disc.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// The patch to start from: shortest paths over the surface along the feature graph's tree, thickened (§2.3
/// of the design). The paper (§4.2, §4.3) fills the faces of the graph instead and asks the artist for more
/// features where their paths cross; a thickened tree is a disc for any features, so nobody is asked.
struct Seed {
  ImmersedDisc disc;
  std::vector<PatchFaceId> feature_faces;    ///< The patch face over each feature, pinned.
  std::vector<std::vector<VertexId>> paths;  ///< By edge of the tree: the surface vertices passed.
};

/// `features` lie on faces of the surface's mesh and `tree` spans them. Every surface face is covered at most
/// `cover_limit` times. Fails, naming a pair, only when two features lie on parts that are not connected.
struct SeedFailure {
  FeaturePair disconnected;
};
tl::expected<Seed, SeedFailure> build_seed(BridgedSurface& surface, std::span<const SurfacePoint> features,
                                           std::span<const FeaturePair> tree, std::uint32_t cover_limit);

}  // namespace applique
