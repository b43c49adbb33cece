#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/ids.h"
#include "applique/base/types.h"

namespace applique {

/// The model's surface as one triangle mesh, welded by position, immutable: an oriented 2-manifold with or
/// without boundary. Corner k of a face is opposite its edge k, which runs from corner k+1 to corner k+2.
/// UV seams, split vertices and borders between primitives do not show in it.
struct SurfaceMesh {
  IdVector<VertexId, Vec3> positions;                  ///< Scene units.
  IdVector<FaceId, std::array<VertexId, 3>> faces;     ///< Counter-clockwise seen from outside.
  IdVector<FaceId, std::array<FaceId, 3>> neighbours;  ///< Across edge k; invalid at a boundary.
  IdVector<FaceId, std::array<std::uint8_t, 3>>
      neighbour_edges;                          ///< The neighbour's own number of that edge.
  IdVector<VertexId, FaceId> vertex_face;       ///< One face at the vertex.
  IdVector<VertexId, std::uint32_t> degree;     ///< Number of faces at the vertex.
  IdVector<FaceId, std::uint32_t> source;       ///< Index of the input triangle; corners keep their order.
  IdVector<VertexId, std::uint32_t> component;  ///< Number of the connected component, from 0.

  std::uint32_t cut_edges = 0;          ///< Non-manifold edges that were cut open.
  std::uint32_t split_vertices = 0;     ///< Non-manifold vertices that were split.
  std::uint32_t dropped_triangles = 0;  ///< Input triangles that are degenerate after welding.

  [[nodiscard]] std::array<Vec3, 3> corners(FaceId f) const {
    return {positions[faces[f][0]], positions[faces[f][1]], positions[faces[f][2]]};
  }
};

/// Welds a triangle soup: positions that agree to 2e-7 of the bounding box's diagonal (the precision of the
/// files' floats) become one vertex. An edge with more than two faces, or with two of disagreeing
/// orientation, keeps only the pair that the file itself joins (the same two input vertices) and is cut open
/// otherwise; vertices with several fans are split; triangles with fewer than three distinct vertices are
/// dropped. O(n log n).
SurfaceMesh weld_surface(std::span<const Vec3> positions,
                         std::span<const std::array<std::uint32_t, 3>> triangles);

/// Calls visit(f) for each face at v, once.
template <class Visit>
void for_each_face(const SurfaceMesh& mesh, VertexId v, Visit visit) {
  const FaceId first = mesh.vertex_face[v];
  for (int way = 0; way < 2; ++way) {
    FaceId f = first;
    do {
      if (way == 0 || f != first) visit(f);
      const auto& corners = mesh.faces[f];
      const int c = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
      f = mesh.neighbours[f][way == 0 ? (c + 2) % 3 : (c + 1) % 3];
    } while (f.valid() && f != first);
    if (f.valid()) return;  // a closed fan: one way is enough
  }
}

/// A point of the surface: a face and weights of its corners, >= 0, sum 1.
struct SurfacePoint {
  FaceId face;
  std::array<double, 3> barycentric = {1, 0, 0};
};

Vec3 position_of(const SurfaceMesh& mesh, const SurfacePoint& point);

}  // namespace applique
