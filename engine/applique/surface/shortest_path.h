#pragma once

#include <unordered_set>
#include <vector>

#include "applique/surface/surface_mesh.h"

namespace applique {

/// The shortest path along the surface's edges from one point to another: the vertices passed, in order (at
/// least one), from a corner of `from`'s face to a corner of `to`'s. Empty when the points lie on parts that
/// are not connected. A* with the straight distance as its bound, so that the cost follows the path's
/// neighbourhood. Goes round the `blocked` vertices; empty, too, where that leaves no way.
std::vector<VertexId> shortest_path(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                    const std::unordered_set<VertexId>& blocked = {});

}  // namespace applique
