#include "applique/surface/tangent_frame.h"

namespace applique {
namespace {

constexpr double on_vertex = 1e-9;  // what other corners may weigh

/// Twice the area, along the normal.
Vec3 area_vector(const SurfaceMesh& mesh, FaceId f) {
  const auto [a, b, c] = mesh.corners(f);
  return (b - a).cross(c - a);
}

}  // namespace

Vec3 face_normal(const SurfaceMesh& mesh, FaceId f) {
  return area_vector(mesh, f).normalized();
}

Vec3 vertex_normal(const SurfaceMesh& mesh, VertexId v) {
  Vec3 sum = Vec3::Zero();
  for_each_face(mesh, v, [&](FaceId f) { sum += area_vector(mesh, f); });
  return sum.normalized();
}

VertexId vertex_at(const SurfaceMesh& mesh, const SurfacePoint& point) {
  for (int k = 0; k < 3; ++k)
    if (point.barycentric[k] > 1 - on_vertex) return mesh.faces[point.face][k];
  return {};
}

TangentFrame tangent_frame(const SurfaceMesh& mesh, const SurfacePoint& point) {
  const VertexId v = vertex_at(mesh, point);
  const Vec3 normal = v.valid() ? vertex_normal(mesh, v) : face_normal(mesh, point.face);
  const Vec3 x = normal.unitOrthogonal();
  return {position_of(mesh, point), x, normal.cross(x), normal};
}

Vec3 transport(const Vec3& vector, const Vec3& from_normal, const Vec3& to_normal) {
  return Eigen::Quaterniond::FromTwoVectors(from_normal, to_normal) * vector;
}

}  // namespace applique
