#include "applique/paper/patch_update.h"

#include "applique/paper/continue_map.h"

namespace applique {

PatchUpdate::PatchUpdate(ImmersedDisc& disc, std::vector<PatchVertexId>& features, std::uint32_t cover_limit)
    : disc_(disc), features_(features), cover_limit_(cover_limit) {
  for (PatchVertexId v : features_) disc_.pin(disc_.fan(v)[0]);
}

std::size_t PatchUpdate::remove_outside(const Inside& inside) {
  const auto unwanted = [&](PatchFaceId q) {
    const auto& v = disc_.faces()[q].vertices;
    return !inside[v[0]] && !inside[v[1]] && !inside[v[2]] &&
           removed_[disc_.faces()[q].mesh_face] < cover_limit_;
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

std::size_t PatchUpdate::add_strip(const Inside& inside, std::vector<Vec2>& plane) {
  std::vector<PatchVertexId> boundary;
  for (PatchVertexId v : ids<PatchVertexId>(inside.size()))
    if (inside[v] && disc_.alive(v) && disc_.on_boundary(v)) boundary.push_back(v);
  return complete_fans(boundary, plane);
}

std::size_t PatchUpdate::widen_bridges(const Inside& inside, std::vector<Vec2>& plane) {
  std::vector<PatchVertexId> ends;
  for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size())) {
    if (!disc_.alive(q)) continue;
    const PatchFace& face = disc_.faces()[q];
    for (int k = 0; k < 3; ++k) {
      const PatchVertexId a = face.vertices[(k + 1) % 3], b = face.vertices[(k + 2) % 3];
      if (!face.neighbours[k].valid() || !disc_.on_boundary(a) || !disc_.on_boundary(b)) continue;
      for (PatchVertexId end : {a, b})
        if (inside[end]) ends.push_back(end);
    }
  }
  return complete_fans(ends, plane);
}

std::size_t PatchUpdate::complete_fans(const std::vector<PatchVertexId>& vertices, std::vector<Vec2>& plane) {
  const std::size_t faces = disc_.faces().size(), known = disc_.vertex_count();
  for (PatchVertexId v : vertices) disc_.complete_fan(disc_.survivor(v), cover_limit_);
  plane.resize(disc_.vertex_count());
  std::vector<char> placed(disc_.vertex_count(), false);
  for (PatchVertexId v : ids<PatchVertexId>(known)) {
    const PatchVertexId survivor = disc_.survivor(v);
    plane[survivor.value] = plane[v.value];
    placed[survivor.value] = true;
  }
  continue_map(disc_, placed, plane);
  return disc_.faces().size() - faces;
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
