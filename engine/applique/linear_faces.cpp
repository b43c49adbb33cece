#include "applique/linear_faces.h"

#include <cmath>
#include <initializer_list>
#include <vector>

namespace applique {

IdVector<PatchFaceId, char> linear_faces(const DecalMap& map, double tolerance,
                                         std::span<const PatchFaceId> feature_faces) {
  IdVector<PatchFaceId, char> linear(map.patch.faces.size(), true);
  if (map.warp.steps == 0) return linear;
  // Where interpolation is tested, what it gives there, and the faces that depend on it.
  struct Test {
    Vec2 image;
    PatchFaceId face, across;
  };
  std::vector<Vec2> places;
  std::vector<double> influence;
  std::vector<Test> tests;
  const auto test = [&](std::initializer_list<PatchVertexId> corners, PatchFaceId face, PatchFaceId across) {
    const auto n = static_cast<double>(corners.size());
    Vec2 plane = 0, image = 0;
    for (PatchVertexId v : corners) {
      plane += map.plane[v] / n;
      image += map.image[v] / n;
    }
    places.push_back(plane);
    tests.push_back({image, face, across});
    for (std::uint32_t g = 0; g < map.groups; ++g) {
      double sum = 0;
      for (PatchVertexId v : corners) sum += map.influence[v.value * map.groups + g] / n;
      influence.push_back(sum);
    }
  };
  for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    const auto& [mesh_face, v, neighbours] = map.patch.faces[q];
    if (!map.textured[q]) continue;
    test({v[0], v[1], v[2]}, q, {});
    for (int k = 0; k < 3; ++k) {
      const PatchFaceId across = neighbours[k];
      if (across.valid() && map.textured[across] && across < q) continue;  // tested from there
      const PatchVertexId a = v[(k + 1) % 3], b = v[(k + 2) % 3];
      test({a, b}, q, across);
      // An influence that goes from 0 to 1 along the side is right in its middle.
      if (map.groups > 1) {
        test({a, a, a, b}, q, across);
        test({a, b, b, b}, q, across);
      }
    }
  }
  const std::vector<Vec2> exact = warp_all(map.warp, places, influence);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (std::abs(exact[i] - tests[i].image) <= tolerance) continue;
    linear[tests[i].face] = false;
    if (tests[i].across.valid()) linear[tests[i].across] = false;
  }
  for (PatchFaceId q : feature_faces) linear[q] = false;
  return linear;
}

}  // namespace applique
