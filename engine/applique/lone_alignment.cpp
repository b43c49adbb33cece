#include "applique/lone_alignment.h"

#include <set>

#include "applique/decal_input.h"

namespace applique {

Result<Similarity> lone_alignment(const SurfaceMesh& surface, const DecalInput& input,
                                  const ImmersedDisc& disc, PatchFaceId feature_face, Vec2 feature,
                                  Vec2 target, const std::vector<Vec2>& plane) {
  // The complex derivative of the embedding at the feature, in the tangent frame whose y axis is `up`.
  std::set<PatchFaceId> near;
  for (PatchVertexId v : disc.faces()[feature_face].vertices)
    for (PatchFaceId q : disc.fan(v)) near.insert(q);
  Vec3 normal = Vec3::Zero();
  for (PatchFaceId q : near) {
    const auto& v = disc.faces()[q].vertices;
    normal += (disc.position(v[1]) - disc.position(v[0])).cross(disc.position(v[2]) - disc.position(v[0]));
  }
  const auto own = surface.corners(input.features[0].surface.face);
  if (normal.dot((own[1] - own[0]).cross(own[2] - own[0])) <= 0)
    normal = (own[1] - own[0]).cross(own[2] - own[0]);
  normal.normalize();
  APPLIQUE_TRY(const Vec3 y, lone_up(input, normal));
  const Vec3 x = y.cross(normal);
  Vec2 derivative = 0;
  double total = 0;
  for (PatchFaceId q : near) {
    const auto& v = disc.faces()[q].vertices;
    const Vec3 d1 = disc.position(v[1]) - disc.position(v[0]), d2 = disc.position(v[2]) - disc.position(v[0]);
    const Vec2 a(d1.dot(x), d1.dot(y)), b(d2.dot(x), d2.dot(y));
    const double twice_area = cross(a, b);
    if (twice_area <= 0) continue;
    const Vec2 p = plane[v[1].value] - plane[v[0].value], q2 = plane[v[2].value] - plane[v[0].value];
    // d/dz of the affine map a -> p, b -> q2, times the area.
    derivative += Vec2(0, 0.25) * (p * std::conj(b) - q2 * std::conj(a));
    total += 0.5 * twice_area;
  }
  derivative /= total;
  const Vec2 scale = lone_scale(input) / derivative;
  return Similarity{scale, target - scale * feature};
}

}  // namespace applique
