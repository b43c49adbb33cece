#include "applique/embed/self_overlap.h"

#include <algorithm>
#include <vector>

#include "applique/base/predicates.h"

namespace applique {
namespace {

constexpr double far_share = 0.1;  // of the region's diameter: as in growth

struct RimEdge {
  Vec2 from, to;
  Vec2 image;  ///< Its middle.
  double left, right, bottom, top;
};

/// The edges between some faces and what is none of them.
std::vector<RimEdge> find_rim(const ImmersedDisc& disc, const PatchPoints& points,
                              const IdVector<PatchFaceId, char>& among) {
  std::vector<RimEdge> rim;
  for (PatchFaceId q : ids<PatchFaceId>(among.size())) {
    if (!among[q]) continue;
    const PatchFace& face = disc.faces()[q];
    for (int k = 0; k < 3; ++k) {
      if (face.neighbours[k].valid() && among[face.neighbours[k]]) continue;
      const PatchPoint &a = points[face.vertices[(k + 1) % 3]], &b = points[face.vertices[(k + 2) % 3]];
      const auto [left, right] = std::minmax({a.plane.real(), b.plane.real()});
      const auto [bottom, top] = std::minmax({a.plane.imag(), b.plane.imag()});
      rim.push_back({a.plane, b.plane, 0.5 * (a.image + b.image), left, right, bottom, top});
    }
  }
  return rim;
}

bool cross_properly(const RimEdge& e, const RimEdge& f) {
  if (e.top < f.bottom || f.top < e.bottom) return false;
  return orientation(e.from, e.to, f.from) * orientation(e.from, e.to, f.to) < 0 &&
         orientation(f.from, f.to, e.from) * orientation(f.from, f.to, e.to) < 0;
}

/// Whether edges cross whose middles are farther apart than that in the image.
bool any_cross(std::vector<RimEdge> rim, double far) {
  std::sort(rim.begin(), rim.end(), [](const RimEdge& e, const RimEdge& f) { return e.left < f.left; });
  // A sweep from left to right: only edges whose columns overlap can cross.
  std::vector<const RimEdge*> open;
  for (const RimEdge& edge : rim) {
    std::erase_if(open, [&](const RimEdge* other) { return other->right < edge.left; });
    for (const RimEdge* other : open)
      if (cross_properly(edge, *other) && std::abs(other->image - edge.image) > far) return true;
    open.push_back(&edge);
  }
  return false;
}

}  // namespace

bool overlaps_in_plane(const ImmersedDisc& disc, const PatchPoints& points, const Region& region) {
  IdVector<PatchVertexId, char> inside(disc.vertex_count(), false);
  for (PatchVertexId v : ids<PatchVertexId>(disc.vertex_count()))
    inside[v] = disc.alive(v) && region.contains(points[v].image);
  IdVector<PatchFaceId, char> covered(disc.faces().size(), false);
  for (PatchFaceId q : ids<PatchFaceId>(covered.size())) {
    const auto& v = disc.faces()[q].vertices;
    covered[q] = disc.alive(q) && inside[v[0]] && inside[v[1]] && inside[v[2]];
  }
  return any_cross(find_rim(disc, points, covered), far_share * region.diameter());
}

bool is_injective(const ImmersedDisc& disc, const PatchPoints& points,
                  const IdVector<PatchFaceId, char>& among) {
  for (PatchFaceId q : ids<PatchFaceId>(among.size())) {
    const auto& v = disc.faces()[q].vertices;
    if (among[q] && orientation(points[v[0]].plane, points[v[1]].plane, points[v[2]].plane) <= 0)
      return false;
  }
  return !any_cross(find_rim(disc, points, among), -1);
}

}  // namespace applique
