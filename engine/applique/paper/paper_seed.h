#pragma once

#include <vector>

#include "applique/paper/graph_paths.h"
#include "applique/patch/immersed_disc.h"

namespace applique {

/// The seed patch of §4.2 of the paper (Fig. 5).
struct PaperSeed {
  ImmersedDisc disc;                             ///< Its ids are compact.
  std::vector<PatchVertexId> features;           ///< The patch vertex of each feature.
  std::vector<std::vector<PatchFaceId>> sheets;  ///< By face of G_I: the patch faces over its region.
};

/// Merges the triangles of the faces' regions and those along the bridging paths. Glued together from the
/// features' fans, so that it stays a disc: the paper's merging rule (Fig. 18) can make an annulus or a
/// sphere (E18 of the design). A bridging path or a region that meets what lies there already gets a sheet of
/// its own (Fig. 7). Error not_solved, naming the features, where the sheet has no room.
Result<PaperSeed> build_paper_seed(BridgedSurface& surface, const DecalInput& input,
                                   const std::vector<VertexFeature>& features, const ConvexGraph& graph,
                                   const GraphPaths& paths, const std::vector<std::vector<FaceId>>& regions);

}  // namespace applique
