#include "applique/paper/patch_update.h"

#include "applique/paper/continue_map.h"

namespace applique {

PatchUpdate::PatchUpdate(ImmersedDisc& disc, std::vector<PatchVertexId>& features, const Region& region,
                         std::uint32_t cover_limit)
    : disc_(disc), features_(features), region_(region), cover_limit_(cover_limit) {
  for (PatchVertexId v : features_) disc_.pin(disc_.fan(v)[0]);
}

std::size_t PatchUpdate::remove_outside(const LocatedPatch& located) {
  const auto& inside = located.inside;
  const auto& image = located.image;
  const auto unwanted = [&](PatchFaceId q) {
    const auto& v = disc_.faces()[q].vertices;
    return !inside[v[0]] && !inside[v[1]] && !inside[v[2]] &&
           removed_[disc_.faces()[q].mesh_face] < cover_limit_ &&
           !region_.meets_triangle(image[v[0]], image[v[1]], image[v[2]]);
  };
  std::vector<PatchFaceId> work;
  for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
    if (disc_.alive(q) && unwanted(q)) work.push_back(q);
  std::size_t count = 0;
  for (std::size_t i = 0; i < work.size(); ++i) {
    const PatchFaceId q = work[i];
    if (!disc_.alive(q) || !unwanted(q) || !disc_.removable(q)) continue;
    const PatchFace face = disc_.faces()[q];
    disc_.remove(q);
    ++removed_[face.mesh_face];
    ++count;
    for (PatchFaceId across : face.neighbours)
      if (across.valid() && unwanted(across)) work.push_back(across);
  }
  return count;
}

std::size_t PatchUpdate::add_strip(const LocatedPatch& located, std::vector<Vec2>& plane) {
  const std::size_t faces = disc_.faces().size(), known = disc_.vertex_count();
  std::vector<PatchVertexId> boundary;
  for (PatchVertexId v : ids<PatchVertexId>(known))
    if (located.inside[v] && disc_.alive(v) && disc_.on_boundary(v)) boundary.push_back(v);
  std::vector<ImmersedDisc::Side> sides;
  for (PatchFaceId q : ids<PatchFaceId>(faces)) {
    if (!disc_.alive(q)) continue;
    const PatchFace& face = disc_.faces()[q];
    for (int k = 0; k < 3; ++k)
      if (!face.neighbours[k].valid() && region_.meets_segment(located.image[face.vertices[(k + 1) % 3]],
                                                               located.image[face.vertices[(k + 2) % 3]]))
        sides.push_back({q, k});
  }
  complete_fans(boundary);
  for (const auto& [q, k] : sides)
    if (!disc_.faces()[q].neighbours[k].valid()) disc_.glue(q, k, cover_limit_);
  place_new(known, plane);
  return disc_.faces().size() - faces;
}

std::size_t PatchUpdate::widen_bridges(const LocatedPatch& located, std::vector<Vec2>& plane) {
  const std::size_t faces = disc_.faces().size(), known = disc_.vertex_count();
  std::vector<PatchVertexId> ends;
  for (PatchFaceId q : ids<PatchFaceId>(faces)) {
    if (!disc_.alive(q)) continue;
    const PatchFace& face = disc_.faces()[q];
    for (int k = 0; k < 3; ++k) {
      const PatchVertexId a = face.vertices[(k + 1) % 3], b = face.vertices[(k + 2) % 3];
      if (!face.neighbours[k].valid() || !disc_.on_boundary(a) || !disc_.on_boundary(b)) continue;
      for (PatchVertexId end : {a, b})
        if (located.inside[end]) ends.push_back(end);
    }
  }
  complete_fans(ends);
  place_new(known, plane);
  return disc_.faces().size() - faces;
}

void PatchUpdate::complete_fans(const std::vector<PatchVertexId>& vertices) {
  for (PatchVertexId v : vertices) disc_.complete_fan(disc_.survivor(v), cover_limit_);
}

/// Gives a place to the vertices from number `known` on, and those that survived a merge the other's.
void PatchUpdate::place_new(std::size_t known, std::vector<Vec2>& plane) const {
  plane.resize(disc_.vertex_count());
  std::vector<char> placed(disc_.vertex_count(), false);
  for (PatchVertexId v : ids<PatchVertexId>(known)) {
    const PatchVertexId survivor = disc_.survivor(v);
    plane[survivor.value] = plane[v.value];
    placed[survivor.value] = true;
  }
  continue_map(disc_, placed, plane);
}

void PatchUpdate::compact(std::vector<Vec2>& plane) {
  for (PatchVertexId& v : features_) v = disc_.survivor(v);
  const ImmersedDisc::Renumbering map = disc_.compact();
  std::vector<Vec2> compacted(disc_.vertex_count());
  for (PatchVertexId v : ids<PatchVertexId>(map.vertices.size()))
    if (map.vertices[v].valid()) compacted[map.vertices[v].value] = plane[v.value];
  plane = std::move(compacted);
  for (PatchVertexId& v : features_) v = map.vertices[v];
}

}  // namespace applique
