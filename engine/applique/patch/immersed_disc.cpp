#include "applique/patch/immersed_disc.h"

#include <algorithm>
#include <map>
#include <set>

namespace applique {
namespace {

/// Edge k of a face runs from corner k + 1 to corner k + 2; at corner c the outgoing edge is c + 2, the
/// incoming c + 1.
constexpr int next(int k) {
  return (k + 1) % 3;
}
constexpr int previous(int k) {
  return (k + 2) % 3;
}

}  // namespace

ImmersedDisc::ImmersedDisc(BridgedSurface& surface, FaceId first) : surface_(&surface) {
  PatchFace face{first, {}, {}};
  for (int k = 0; k < 3; ++k)
    face.vertices[k] = vertices_.push_back({surface.vertices(first)[k], PatchFaceId(0), 1, {}});
  faces_.push_back(face);
  pinned_.push_back(false);
  cover_[first] = 1;
  live_faces_ = 1;
  boundary_length_ = 3;
}

int ImmersedDisc::corner(PatchFaceId q, PatchVertexId v) const {
  const auto& corners = faces_[q].vertices;
  return corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
}

int ImmersedDisc::back_edge(PatchFaceId q, int k) const {
  return surface_->neighbour_edge(faces_[q].mesh_face, k);
}

PatchVertexId ImmersedDisc::survivor(PatchVertexId v) const {
  while (vertices_[v].merged_into.valid()) v = vertices_[v].merged_into;
  return v;
}

std::uint32_t ImmersedDisc::cover(FaceId f) const {
  const auto found = cover_.find(f);
  return found == cover_.end() ? 0 : found->second;
}

ImmersedDisc::Side ImmersedDisc::outgoing_boundary(PatchVertexId v) const {
  const PatchFaceId first = vertices_[v].face;
  PatchFaceId q = first;
  while (true) {
    const int edge = previous(corner(q, v));
    const PatchFaceId across = faces_[q].neighbours[edge];
    if (!across.valid()) return {q, edge};
    if (across == first) return {};
    q = across;
  }
}

ImmersedDisc::Side ImmersedDisc::incoming_boundary(PatchVertexId v) const {
  const PatchFaceId first = vertices_[v].face;
  PatchFaceId q = first;
  while (true) {
    const int edge = next(corner(q, v));
    const PatchFaceId across = faces_[q].neighbours[edge];
    if (!across.valid()) return {q, edge};
    if (across == first) return {};
    q = across;
  }
}

bool ImmersedDisc::on_boundary(PatchVertexId v) const {
  return outgoing_boundary(v).face.valid();
}

std::vector<PatchFaceId> ImmersedDisc::fan(PatchVertexId v) const {
  std::vector<PatchFaceId> fan;
  const Side start = outgoing_boundary(v);
  const PatchFaceId first = start.face.valid() ? start.face : vertices_[v].face;
  PatchFaceId q = first;
  do {
    fan.push_back(q);
    q = faces_[q].neighbours[next(corner(q, v))];
  } while (q.valid() && q != first);
  return fan;
}

PatchVertexId ImmersedDisc::neighbour_over(PatchVertexId v, VertexId target) const {
  if (mesh_vertex(v) == target) return v;
  for (PatchFaceId q : fan(v))
    for (PatchVertexId w : faces_[q].vertices)
      if (mesh_vertex(w) == target) return w;
  return {};
}

ImmersedDisc::GlueResult ImmersedDisc::glue(PatchFaceId q, int k, std::uint32_t cover_limit) {
  APPLIQUE_ASSERT(alive(q) && !faces_[q].neighbours[k].valid());
  const FaceId g = surface_->neighbour(faces_[q].mesh_face, k);
  if (!g.valid()) return {Glue::boundary, {}, {}};
  std::uint32_t& cover = cover_[g];
  if (cover >= cover_limit) return {Glue::covered, {}, {}};
  const PatchVertexId a = faces_[q].vertices[next(k)], b = faces_[q].vertices[previous(k)];
  if (full(a) || full(b)) return {Glue::wrapped, {}, {}};
  if (boundary_length_ <= 3 && live_faces_ > 1) return {Glue::closed, {}, {}};

  const int e = back_edge(q, k);
  const PatchFaceId added(faces_.size());
  const PatchVertexId apex = vertices_.push_back({surface_->vertices(g)[e], added, 1, {}});
  PatchFace face{g, {}, {}};
  face.vertices[e] = apex;
  face.vertices[next(e)] = b;
  face.vertices[previous(e)] = a;
  face.neighbours[e] = q;
  faces_.push_back(face);
  pinned_.push_back(false);
  faces_[q].neighbours[k] = added;
  ++vertices_[a].fan;
  ++vertices_[b].fan;
  ++cover;
  ++live_faces_;
  ++boundary_length_;
  zip(a);
  zip(survivor(b));
  const PatchVertexId top = survivor(apex);
  return {Glue::glued, added, top, top != apex};
}

void ImmersedDisc::zip(PatchVertexId x) {
  while (true) {
    const Side out = outgoing_boundary(x);
    if (!out.face.valid() || boundary_length_ < 5 || !full(x)) return;
    const Side in = incoming_boundary(x);
    const PatchVertexId w = faces_[out.face].vertices[previous(out.edge)];
    const PatchVertexId y = faces_[in.face].vertices[next(in.edge)];
    const FaceId over_out = faces_[out.face].mesh_face, over_in = faces_[in.face].mesh_face;
    const bool same_edge = surface_->neighbour(over_out, out.edge) == over_in &&
                           surface_->neighbour_edge(over_out, out.edge) == in.edge;
    if (!same_edge || y == w) return;
    if (vertices_[y].fan + vertices_[w].fan > surface_->degree(vertices_[y].mesh_vertex)) return;
    faces_[out.face].neighbours[out.edge] = in.face;
    faces_[in.face].neighbours[in.edge] = out.face;
    boundary_length_ -= 2;
    // The smaller fan is rewritten; which of the two ids survives means nothing.
    const bool keep_y = vertices_[y].fan >= vertices_[w].fan;
    x = keep_y ? y : w;
    merge(keep_y ? w : y, x);
  }
}

void ImmersedDisc::merge(PatchVertexId from, PatchVertexId into) {
  // The two fans are already joined by the edge just zipped, so walk them both from one of `from`'s faces.
  Vertex& dead = vertices_[from];
  for (int way = 0; way < 2; ++way) {
    PatchFaceId q = dead.face;
    while (q.valid()) {
      auto& corners = faces_[q].vertices;
      int c = static_cast<int>(std::find(corners.begin(), corners.end(), from) - corners.begin());
      if (c == 3) {
        if (way == 0 || q != dead.face) break;
        c = corner(q, into);  // rewritten on the first way
      }
      corners[c] = into;
      q = faces_[q].neighbours[way == 0 ? previous(c) : next(c)];
    }
  }
  vertices_[into].fan += dead.fan;
  dead = {dead.mesh_vertex, {}, 0, into};
}

void ImmersedDisc::close_slits() {
  for (PatchVertexId v : ids<PatchVertexId>(vertices_.size()))
    if (alive(v)) zip(v);
}

std::optional<ImmersedDisc::Side> ImmersedDisc::open_side(PatchVertexId v) const {
  const Side out = outgoing_boundary(v);
  return out.face.valid() ? std::optional(out) : std::nullopt;
}

PatchVertexId ImmersedDisc::complete_fan(PatchVertexId v, std::uint32_t cover_limit) {
  return complete_fan(v, [&](FaceId) { return cover_limit; });
}

PatchVertexId ImmersedDisc::complete_fan(PatchVertexId v,
                                         const std::function<std::uint32_t(FaceId)>& cover_limit) {
  const auto glue_at = [&](const Side& side) {
    const FaceId beyond = surface_->neighbour(faces_[side.face].mesh_face, side.edge);
    return beyond.valid() && glue(side.face, side.edge, cover_limit(beyond)).outcome == Glue::glued;
  };
  while (!full(v)) {
    const Side out = outgoing_boundary(v);
    if (!out.face.valid()) return v;
    if (!glue_at(out) && !glue_at(incoming_boundary(v))) return v;
    v = survivor(v);
  }
  return v;
}

bool ImmersedDisc::removable(PatchFaceId q) const {
  if (pinned_[q] || live_faces_ <= 1) return false;
  int boundary_edges = 0, edge = 0;
  for (int k = 0; k < 3; ++k)
    if (!faces_[q].neighbours[k].valid()) {
      ++boundary_edges;
      edge = k;
    }
  return boundary_edges == 2 || (boundary_edges == 1 && !on_boundary(faces_[q].vertices[edge]));
}

void ImmersedDisc::remove(PatchFaceId q) {
  APPLIQUE_ASSERT(removable(q));
  PatchFace& face = faces_[q];
  int boundary_edges = 0;
  for (int k = 0; k < 3; ++k) {
    const PatchFaceId across = face.neighbours[k];
    if (across.valid())
      faces_[across].neighbours[back_edge(q, k)] = PatchFaceId();
    else
      ++boundary_edges;
  }
  for (int c = 0; c < 3; ++c) {
    Vertex& v = vertices_[face.vertices[c]];
    --v.fan;
    const PatchFaceId one = face.neighbours[next(c)], other = face.neighbours[previous(c)];
    if (v.face == q) v.face = one.valid() ? one : other;
  }
  if (boundary_edges == 2)
    --boundary_length_;
  else
    ++boundary_length_;
  --cover_[face.mesh_face];
  --live_faces_;
  face = PatchFace{};
}

ImmersedDisc::Renumbering ImmersedDisc::compact() {
  Renumbering map;
  map.faces.resize(faces_.size());
  map.vertices.resize(vertices_.size());
  std::uint32_t face_count = 0, vertex_count = 0;
  for (PatchFaceId q : ids<PatchFaceId>(faces_.size()))
    if (alive(q)) map.faces[q] = PatchFaceId(face_count++);
  for (PatchVertexId v : ids<PatchVertexId>(vertices_.size()))
    if (alive(v)) map.vertices[v] = PatchVertexId(vertex_count++);
  for (PatchFaceId q : ids<PatchFaceId>(faces_.size())) {
    if (!alive(q)) continue;
    PatchFace face = faces_[q];
    for (int k = 0; k < 3; ++k) {
      face.vertices[k] = map.vertices[face.vertices[k]];
      if (face.neighbours[k].valid()) face.neighbours[k] = map.faces[face.neighbours[k]];
    }
    faces_[map.faces[q]] = face;
    pinned_[map.faces[q]] = pinned_[q];
  }
  for (PatchVertexId v : ids<PatchVertexId>(vertices_.size())) {
    if (!map.vertices[v].valid()) continue;
    Vertex vertex = vertices_[v];
    vertex.face = map.faces[vertex.face];
    vertices_[map.vertices[v]] = vertex;
  }
  faces_.resize(face_count);
  pinned_.resize(face_count);
  vertices_.resize(vertex_count);
  return map;
}

std::string ImmersedDisc::broken_invariant() const {
  std::size_t live_vertices = 0, live_faces = 0, boundary_edges = 0, sides = 0;
  std::map<FaceId, std::uint32_t> cover;
  PatchVertexId boundary_start;
  for (PatchFaceId q : ids<PatchFaceId>(faces_.size())) {
    if (!alive(q)) continue;
    const PatchFace& face = faces_[q];
    ++live_faces;
    ++cover[face.mesh_face];
    for (int k = 0; k < 3; ++k) {
      ++sides;
      if (!alive(face.vertices[k])) return "a live face has a dead vertex";
      if (mesh_vertex(face.vertices[k]) != surface_->vertices(face.mesh_face)[k])
        return "a corner does not lie over its surface vertex";
      const PatchFaceId across = face.neighbours[k];
      if (!across.valid()) {
        ++boundary_edges;
        boundary_start = face.vertices[next(k)];
        continue;
      }
      const int back = back_edge(q, k);
      if (!alive(across) || faces_[across].neighbours[back] != q) return "neighbours are not mutual";
      if (surface_->neighbour(face.mesh_face, k) != faces_[across].mesh_face)
        return "patch neighbours are not neighbours on the surface";
      if (faces_[across].vertices[next(back)] != face.vertices[previous(k)] ||
          faces_[across].vertices[previous(back)] != face.vertices[next(k)])
        return "neighbours do not share their edge's vertices";
    }
  }
  for (PatchVertexId v : ids<PatchVertexId>(vertices_.size())) {
    if (!alive(v)) continue;
    ++live_vertices;
    const std::vector<PatchFaceId> faces = fan(v);
    std::set<FaceId> distinct;
    for (PatchFaceId q : faces) {
      if (!alive(q) || faces_[q].vertices[corner(q, v)] != v) return "a fan leaves its vertex";
      distinct.insert(faces_[q].mesh_face);
    }
    if (faces.size() != vertices_[v].fan) return "a vertex has more than one fan";
    if (distinct.size() != faces.size()) return "a fan covers a surface face twice";
    if (faces.size() > surface_->degree(vertices_[v].mesh_vertex))
      return "a fan is larger than the surface's";
  }
  if (live_faces != live_faces_) return "the count of faces is wrong";
  if (boundary_edges != boundary_length_) return "the boundary's length is wrong";
  if (boundary_length_ < 3) return "the boundary is shorter than three edges";
  if (live_vertices + live_faces != (sides + boundary_edges) / 2 + 1)
    return "the Euler characteristic is not 1";
  std::size_t loop = 0;
  PatchVertexId v = boundary_start;
  do {
    const Side out = outgoing_boundary(v);
    v = faces_[out.face].vertices[previous(out.edge)];
    ++loop;
  } while (v != boundary_start && loop <= boundary_edges);
  if (loop != boundary_edges) return "the boundary has more than one loop";
  for (const auto& [f, count] : cover)
    if (count != this->cover(f)) return "the cover count is wrong";
  return {};
}

}  // namespace applique
