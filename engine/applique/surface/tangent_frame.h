#pragma once

#include "applique/surface/surface_mesh.h"

namespace applique {

/// Unit normal of a face, outward; zero when the face is degenerate.
Vec3 face_normal(const SurfaceMesh& mesh, FaceId f);
/// Unit normal at a vertex: the mean of its faces' normals, weighted by their areas.
Vec3 vertex_normal(const SurfaceMesh& mesh, VertexId v);

/// The vertex that a surface point lies on; invalid when it is on none.
VertexId vertex_at(const SurfaceMesh& mesh, const SurfacePoint& point);

/// A place on the surface with axes of its tangent plane: unit vectors, x, y and normal right-handed.
struct TangentFrame {
  Vec3 origin, x, y, normal;

  /// A point of space, projected along the normal; scene units.
  [[nodiscard]] Vec2 coordinates(const Vec3& p) const { return {(p - origin).dot(x), (p - origin).dot(y)}; }
  /// How far a point is above the tangent plane, scene units.
  [[nodiscard]] double height(const Vec3& p) const { return (p - origin).dot(normal); }
};

/// A frame at a surface point, with the vertex's normal if it lies on one, else its face's. Which way x runs
/// in the plane is arbitrary.
TangentFrame tangent_frame(const SurfaceMesh& mesh, const SurfacePoint& point);

/// A tangent vector carried from a plane to another by the smallest rotation that takes the one's unit normal
/// to the other's.
Vec3 transport(const Vec3& vector, const Vec3& from_normal, const Vec3& to_normal);

}  // namespace applique
