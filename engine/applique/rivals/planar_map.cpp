#include "applique/rivals/planar_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

namespace applique {
namespace {

bool within(const SurfaceMesh& surface, FaceId f, const TangentFrame& frame, const PlanarLimits& limits) {
  const auto corners = surface.corners(f);
  const double slope = face_normal(surface, f).dot(frame.normal);
  return slope > std::cos(limits.normal_limit * std::numbers::pi / 180) - 1e-12 &&
         std::all_of(corners.begin(), corners.end(),
                     [&](const Vec3& p) { return std::abs(frame.height(p)) <= limits.depth; });
}

}  // namespace

Result<RivalMap> project_planar(const SurfaceMesh& surface, const RivalTask& task,
                                const PlanarLimits& limits) {
  RivalMap map;
  for (const Feature& feature : task.input.features)
    map.features.push_back(task.frame.coordinates(position_of(surface, feature.surface)));
  APPLIQUE_TRY(const Similarity placed, place_in_image(surface, task, map.features));
  for (Vec2& z : map.features) z = placed(z);

  const RegionBox box(task.input.region);
  const auto image_of = [&](VertexId v) {
    const auto [entry, fresh] = map.image.try_emplace(v);
    if (fresh) entry->second = placed(task.frame.coordinates(surface.positions[v]));
    return entry->second;
  };
  std::unordered_set<FaceId> seen;
  const auto reach = [&](FaceId f) {
    if (f.valid() && seen.insert(f).second && within(surface, f, task.frame, limits)) map.faces.push_back(f);
  };
  const SurfacePoint& anchor = task.input.features[task.anchor].surface;
  if (const VertexId v = vertex_at(surface, anchor); v.valid())
    for_each_face(surface, v, reach);
  else
    reach(anchor.face);
  for (std::size_t i = 0; i < map.faces.size(); ++i) {
    const FaceId f = map.faces[i];
    const auto& [a, b, c] = surface.faces[f];
    if (box.meets({image_of(a), image_of(b), image_of(c)}))
      for (FaceId g : surface.neighbours[f]) reach(g);
  }
  return map;
}

}  // namespace applique
