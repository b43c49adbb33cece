#pragma once

#include <vector>

#include "applique/paper/graph_paths.h"

namespace applique {

/// By face of G_I, the surface's triangles that the face's paths bound (§4.2 of the paper, Fig. 5): what a
/// flood reaches from the left of the paths without crossing them.
///
/// The paper takes it for granted that there is such a region, and asks for another feature where an isolated
/// one lies outside it (Fig. 6). Error not_solved, which names the features and a place in the image: the
/// flood reaches the paths' other side, or many times the area that the paths' lengths let expect (as it does
/// all round a model when the features are mirrored); it is no disc; an isolated feature is not inside.
Result<std::vector<std::vector<FaceId>>> find_face_regions(const SurfaceMesh& surface,
                                                           const DecalInput& input,
                                                           const std::vector<VertexFeature>& features,
                                                           const ConvexGraph& graph, const GraphPaths& paths);

}  // namespace applique
