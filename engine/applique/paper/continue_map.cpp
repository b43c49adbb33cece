#include "applique/paper/continue_map.h"

#include <array>

namespace applique {
namespace {

/// The corner c of a triangle a b c, counter-clockwise, in the frame of the edge from a to b.
Vec2 in_edge_frame(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 edge = b - a, side = c - a;
  const double length2 = edge.squaredNorm();
  return {side.dot(edge) / length2, edge.cross(side).norm() / length2};
}

}  // namespace

void continue_map(const ImmersedDisc& disc, std::vector<char>& placed, std::vector<Vec2>& map) {
  std::vector<PatchFaceId> waiting;
  for (PatchFaceId q : ids<PatchFaceId>(disc.faces().size()))
    if (disc.alive(q)) waiting.push_back(q);
  for (std::size_t before = waiting.size() + 1; waiting.size() < before;) {
    before = waiting.size();
    std::erase_if(waiting, [&](PatchFaceId q) {
      const auto& v = disc.faces()[q].vertices;
      for (int k = 0; k < 3; ++k) {
        const PatchVertexId a = v[(k + 1) % 3], b = v[(k + 2) % 3], c = v[k];
        if (!placed[a.value] || !placed[b.value]) continue;
        if (!placed[c.value]) {
          map[c.value] =
              map[a.value] + (map[b.value] - map[a.value]) *
                                 in_edge_frame(disc.position(a), disc.position(b), disc.position(c));
          placed[c.value] = true;
        }
        return true;
      }
      return false;
    });
  }
}

}  // namespace applique
