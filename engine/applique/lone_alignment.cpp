#include "applique/lone_alignment.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "applique/decal_input.h"

namespace applique {

Result<Similarity> lone_alignment(const SurfaceMesh& surface, const DecalInput& input,
                                  const ImmersedDisc& disc, PatchFaceId feature_face, Vec2 feature,
                                  Vec2 target, const std::vector<Vec2>& plane) {
  // The complex derivative of the embedding about the feature, in its face's tangent frame whose y axis is
  // `up`. Faces about it are turned into that plane, so that none is foreshortened. Those that face another
  // way, over an edge of the surface, hardly count, and none but its own where that is as large as the image.
  const auto own = surface.corners(input.features[0].surface.face);
  std::set<PatchFaceId> near;
  for (PatchVertexId v : disc.faces()[feature_face].vertices)
    for (PatchFaceId q : disc.fan(v)) near.insert(q);
  Vec3 normal = (own[1] - own[0]).cross(own[2] - own[0]);
  // A face without an area to speak of has the normal of the largest beside it.
  if (normal.norm() <= 1e-9 * std::max((own[1] - own[0]).squaredNorm(), (own[2] - own[0]).squaredNorm()))
    for (const PatchFaceId q : near) {
      const auto& v = disc.faces()[q].vertices;
      const Vec3 beside =
          (disc.position(v[1]) - disc.position(v[0])).cross(disc.position(v[2]) - disc.position(v[0]));
      if (beside.norm() > normal.norm()) normal = beside;
    }
  normal.normalize();
  APPLIQUE_TRY(const Vec3 y, lone_up(input, normal));
  const Vec3 x = y.cross(normal);
  const double own_area = 0.5 * (own[1] - own[0]).cross(own[2] - own[0]).norm();
  const double image_area = input.region.area() / std::pow(lone_scale(input), 2);
  const double regard = std::max(0.0, 1 - own_area / image_area);
  Vec2 derivative = 0;
  double total = 0;
  for (PatchFaceId q : near) {
    const auto& v = disc.faces()[q].vertices;
    const Vec3 d1 = disc.position(v[1]) - disc.position(v[0]), d2 = disc.position(v[2]) - disc.position(v[0]);
    const Vec3 facing = d1.cross(d2).normalized();
    const double alike = facing.dot(normal);
    if (!(alike > 0)) continue;
    const auto turn = Eigen::Quaterniond::FromTwoVectors(facing, normal);
    const Vec3 flat1 = turn * d1, flat2 = turn * d2;
    const Vec2 a(flat1.dot(x), flat1.dot(y)), b(flat2.dot(x), flat2.dot(y));
    const Vec2 p = plane[v[1].value] - plane[v[0].value], q2 = plane[v[2].value] - plane[v[0].value];
    const double weight = q == feature_face ? 1 : regard * std::pow(alike, 4);
    // d/dz of the affine map a -> p, b -> q2, times the area.
    derivative += weight * Vec2(0, 0.25) * (p * std::conj(b) - q2 * std::conj(a));
    total += weight * 0.5 * cross(a, b);
  }
  derivative /= total;
  if (!(std::abs(derivative) > 0) || !std::isfinite(std::abs(derivative)))
    return fail(ErrorCode::not_solved,
                fmt::format("decal '{}': the triangles about its feature have no area; move it", input.name));
  const Vec2 scale = lone_scale(input) / derivative;
  return Similarity{scale, target - scale * feature};
}

}  // namespace applique
