#pragma once

#include "applique/paper/paper_seed.h"

namespace applique {

/// The initial parameterization of the seed (§4.3 of the paper, Fig. 8), by patch vertex, plane units: the
/// features at their image points; the vertices of a path spread along the edge of G_I, by arc length (E15 of
/// the design); those inside a face by mean value coordinates. The paper does not say where the triangles
/// along bridging paths have their outer corners: here they continue the path's map.
std::vector<Vec2> map_seed(const PaperSeed& seed, const std::vector<VertexFeature>& features,
                           const ConvexGraph& graph, const GraphPaths& paths);

}  // namespace applique
