#include "compare/pins.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "applique/region/region_locator.h"

namespace applique::compare {
namespace {

constexpr double on_the_map = 1e-6;  // plane units that a located place may be off

/// The textured faces of a map, flat in the image.
struct FlatPatch {
  RegionTriangulation triangles;
  std::vector<PatchFaceId> faces;  ///< By triangle.
};

FlatPatch flatten(const DecalMap& map) {
  FlatPatch flat;
  flat.triangles.points = map.image.raw();
  for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    if (!map.textured[q]) continue;
    const auto& v = map.patch.faces[q].vertices;
    flat.triangles.triangles.push_back({v[0].value, v[1].value, v[2].value});
    flat.faces.push_back(q);
  }
  return flat;
}

Vec2 interpolate(const IdVector<PatchVertexId, Vec2>& at, const PatchFace& face,
                 const std::array<double, 3>& barycentric) {
  Vec2 z = 0;
  for (std::size_t k = 0; k < 3; ++k) z += barycentric[k] * at[face.vertices[k]];
  return z;
}

}  // namespace

DecalInput one_pin(const Site& site, const Layout& layout, const std::string& name) {
  return {name, layout.region, {{layout.pins[0], site.anchor}}, LoneFrame{site.width, site.up}};
}

Result<std::vector<Feature>> pins_of_map(const DecalMap& map, const Layout& layout, int count) {
  const FlatPatch flat = flatten(map);
  const RegionLocator locator(flat.triangles);
  std::vector<Feature> features;
  for (int k = 0; k < count; ++k) {
    const Pixel pin = layout.pins[static_cast<std::size_t>(k)];
    const Vec2 target = layout.region.frame().to_plane(pin);
    const RegionLocation location = locator.locate(target);
    const PatchFace& face = map.patch.faces[flat.faces[location.triangle]];
    if (std::abs(interpolate(map.image, face, location.barycentric) - target) > on_the_map)
      return fail(
          ErrorCode::not_solved,
          fmt::format("the default's map of one pin does not cover pin {} at ({:.0f}, {:.0f}): choose "
                      "a smaller width for the site",
                      k, pin.x, pin.y));
    features.push_back({pin, {face.mesh_face, location.barycentric}});
  }
  return features;
}

std::optional<Vec2> image_of(const DecalMap& map, const SurfacePoint& point, Vec2 target) {
  std::optional<Vec2> nearest;
  for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    const PatchFace& face = map.patch.faces[q];
    if (face.mesh_face != point.face) continue;
    const Vec2 at = map.linear[q] ? interpolate(map.image, face, point.barycentric)
                                  : map.warp(interpolate(map.plane, face, point.barycentric),
                                             map.influence_at(face.vertices, point.barycentric));
    if (!nearest || std::abs(at - target) < std::abs(*nearest - target)) nearest = at;
  }
  return nearest;
}

}  // namespace applique::compare
