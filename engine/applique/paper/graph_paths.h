#pragma once

#include <vector>

#include "applique/base/error.h"
#include "applique/decal.h"
#include "applique/paper/convex_graph.h"

namespace applique {

/// A decal's features as the paper has them (§3): each constrains a vertex of the surface.
struct VertexFeature {
  VertexId vertex;  ///< The corner of the feature's face that is nearest to it.
  Vec2 target;      ///< Its image point, plane units.
};

/// Error not_solved: two features have the same vertex. Warns (feature_snapped) of a feature that is moved by
/// more than a tenth of its face's longest edge.
Result<std::vector<VertexFeature>> snap_features(const SurfaceMesh& surface, const DecalInput& input,
                                                 std::vector<Warning>& warnings);

/// The graph G_S on the surface (§4.2 of the paper): by edge of G_I, the vertices of a shortest path along
/// the surface's edges (E14 of the design) from the edge's first feature to its second, both included.
using GraphPaths = std::vector<std::vector<VertexId>>;

/// Paths of one face may only meet in its features. Where a shortest path merely runs along another for a
/// while, as paths along edges do near the feature that they share, it goes round it; where that makes it
/// longer than `longest_detour` allows the two cross, and the paper asks for another feature: error
/// not_solved, which names the face, the features and a place in the image. Paths that share no face may
/// cross (Fig. 7). No path goes through a third feature.
Result<GraphPaths> trace_graph_paths(const SurfaceMesh& surface, const DecalInput& input,
                                     const std::vector<VertexFeature>& features, const ConvexGraph& graph);

/// "features 1, 2 and 5".
std::string feature_list(const std::vector<std::uint32_t>& features);

/// The end of a message that asks for another feature: where in the image the paper wants it.
std::string ask_for_feature(const DecalInput& input, Vec2 place);

}  // namespace applique
