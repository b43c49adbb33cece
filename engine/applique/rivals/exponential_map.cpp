#include "applique/rivals/exponential_map.h"

#include "applique/rivals/geodesic_front.h"

namespace applique {

Result<RivalMap> map_exponential(const SurfaceMesh& surface, const RivalTask& task, Parents parents) {
  const auto& features = task.input.features;
  const SurfacePoint& anchor = features[task.anchor].surface;
  const TangentFrame& frame = task.frame;
  GeodesicFront front(surface, parents);
  if (const VertexId v = vertex_at(surface, anchor); v.valid())
    front.start(v, 0, 0, frame.x, frame.normal);
  else
    for (VertexId corner : surface.faces[anchor.face]) {
      const Vec3& p = surface.positions[corner];
      front.start(corner, (p - frame.origin).norm(), frame.coordinates(p), frame.x, frame.normal);
    }
  front.reach(features);
  std::vector<Vec2> places;
  for (const Feature& feature : features)
    places.push_back(front.image_of(feature.surface, [](Vec2 at) { return at; }));
  APPLIQUE_TRY(const Similarity placed, place_in_image(surface, task, places));
  RivalMap map = front.cover(RegionBox(task.input.region), placed);
  for (const Vec2 z : places) map.features.push_back(placed(z));
  return map;
}

}  // namespace applique
