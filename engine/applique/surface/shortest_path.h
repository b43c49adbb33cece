#pragma once

#include <optional>
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

/// The length of that path, scene units, from point to point; none where there is no way.
std::optional<double> way_length(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to);

}  // namespace applique
