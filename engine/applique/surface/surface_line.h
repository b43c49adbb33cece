#pragma once

#include <vector>

#include "applique/surface/surface_mesh.h"

namespace applique {

/// A line drawn on the surface: straight from each point to the next, in the face between them.
struct SurfaceLine {
  std::vector<Vec3> points;   ///< Scene units; from the second to the last but one on edges.
  std::vector<FaceId> faces;  ///< faces[i] from points[i] to points[i + 1]; consecutive ones share an edge.

  [[nodiscard]] double length() const;
  [[nodiscard]] SurfaceLine reversed() const;
  /// Goes on with a line that begins where this one ends.
  void append(const SurfaceLine& next);
};

/// A geodesic between two points: the shortest path along edges, pulled tight in the sleeve of faces along
/// it, and the sleeve turned to the other side of each vertex that the path bends round where there is less
/// than half a turn on that side (Xin and Wang 2007), until none is left. Locally shortest, so that it bends
/// only at saddles and at the surface's boundary. Empty when the points lie on parts that are not connected.
SurfaceLine geodesic_between(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to);

/// The straightest geodesic (Polthier and Schmies 1998) from a point inside a face along `direction`, of
/// which the part in the face's plane counts. Its length is `length`, scene units, unless it ends before: at
/// a boundary of the surface, or where it comes to a face again.
SurfaceLine geodesic_from(const SurfaceMesh& mesh, const SurfacePoint& from, const Vec3& direction,
                          double length);

}  // namespace applique
