#include "applique/patch/growth.h"

#include <algorithm>
#include <cmath>

namespace applique {
namespace {

constexpr std::size_t most_hole_sides = 64;
constexpr double largest_pocket = 0.15;   // area, share of the patch's
constexpr double longest_pocket_rim = 1;  // share of the region's diameter
constexpr double largest_hole = 0.5;      // perimeter, share of the region's diameter
// Below it two parts of the image are one sheet: the larger of widths of their triangles, along the way from
// one to the other, and a share of the region's diameter.
constexpr double near_widths = 4;
constexpr double near_share = 0.1;

/// The apex of the face beyond edge a -> b, in the frame of that edge, from the triangle's own shape.
Vec2 apex_in_edge_frame(const Vec3& a, const Vec3& b, const Vec3& apex) {
  const Vec3 edge = b - a, side = apex - a;
  const double length2 = edge.squaredNorm();
  return {side.dot(edge) / length2, -side.cross(edge).norm() / length2};
}

double area_of(const BridgedSurface& surface, FaceId f) {
  const auto& v = surface.vertices(f);
  const Vec3 origin = surface.position(v[0]);
  return 0.5 * (surface.position(v[1]) - origin).cross(surface.position(v[2]) - origin).norm();
}

}  // namespace

Growth::Growth(ImmersedDisc& disc, std::vector<PatchFaceId> feature_faces, const Region& region,
               std::uint32_t cover_limit)
    : disc_(disc), feature_faces_(std::move(feature_faces)), region_(region), cover_limit_(cover_limit) {}

template <class Visit, class Crosses>
IdVector<PatchFaceId, char> Growth::flood(const Visit& visit, const Crosses& crosses) const {
  IdVector<PatchFaceId, char> seen(disc_.faces().size(), false);
  std::vector<PatchFaceId> stack;
  const auto reach = [&](PatchFaceId q) {
    if (!q.valid() || seen[q]) return;
    seen[q] = true;
    stack.push_back(q);
  };
  for (PatchFaceId q : feature_faces_) reach(q);
  while (!stack.empty()) {
    const PatchFace& face = disc_.faces()[stack.back()];
    stack.pop_back();
    const auto& v = face.vertices;
    visit(v);
    for (int k = 0; k < 3; ++k)
      if (crosses(v[(k + 1) % 3], v[(k + 2) % 3])) reach(face.neighbours[k]);
  }
  return seen;
}

IdVector<PatchVertexId, char> Growth::inside(const PatchPoints& points) const {
  // The fan of a vertex hangs together by edges at that vertex, so that it is enough to cross the edges that
  // have an end inside.
  IdVector<PatchVertexId, char> inside(disc_.vertex_count(), false);
  flood(
      [&](const std::array<PatchVertexId, 3>& corners) {
        for (PatchVertexId v : corners) inside[v] = inside[v] || region_.contains(points[v].image);
      },
      [&](PatchVertexId a, PatchVertexId b) { return inside[a] || inside[b]; });
  return inside;
}

IdVector<PatchFaceId, char> Growth::shown(const PatchPoints& points) const {
  return flood([](const std::array<PatchVertexId, 3>&) {},
               [&](PatchVertexId a, PatchVertexId b) {
                 return region_.meets_segment(points[a].image, points[b].image);
               });
}

std::size_t Growth::peel(const PatchPoints& points, const IdVector<PatchVertexId, char>& inside) {
  const std::size_t count = disc_.faces().size();
  // A face stays when it or a face round one of its corners has a vertex inside.
  const IdVector<PatchFaceId, char> shown = this->shown(points);
  IdVector<PatchVertexId, char> near(disc_.vertex_count(), false);
  for (PatchFaceId q : ids<PatchFaceId>(count)) {
    if (!disc_.alive(q)) continue;
    const auto& v = disc_.faces()[q].vertices;
    if (inside[v[0]] || inside[v[1]] || inside[v[2]] || shown[q])
      for (PatchVertexId w : v) near[w] = true;
  }
  const auto unwanted = [&](PatchFaceId q) {
    const auto& v = disc_.faces()[q].vertices;
    return !near[v[0]] && !near[v[1]] && !near[v[2]] && peeled_[disc_.faces()[q].mesh_face] < cover_limit_;
  };
  std::vector<PatchFaceId> work;
  for (PatchFaceId q : ids<PatchFaceId>(count))
    if (disc_.alive(q) && unwanted(q)) work.push_back(q);
  std::size_t removed = cover_limit_ > 1 ? peel_doubles(points) : 0;
  for (std::size_t i = 0; i < work.size(); ++i) {
    const PatchFaceId q = work[i];
    if (!disc_.alive(q) || !unwanted(q) || !disc_.removable(q)) continue;
    const PatchFace face = disc_.faces()[q];
    disc_.remove(q);
    ++peeled_[face.mesh_face];
    ++removed;
    for (PatchFaceId across : face.neighbours)
      if (across.valid() && unwanted(across)) work.push_back(across);
  }
  return removed;
}

std::size_t Growth::peel_doubles(const PatchPoints& points) {
  note_cover();
  std::vector<PatchFaceId> work;
  const auto is_double = [&](PatchFaceId q) {
    const auto& [f, v, neighbours] = disc_.faces()[q];
    return disc_.cover(f) > 1 &&
           covered_nearby(f, {points[v[0]].image, points[v[1]].image, points[v[2]].image}, points, q);
  };
  for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
    if (disc_.alive(q) && is_double(q)) work.push_back(q);
  std::size_t removed = 0;
  for (std::size_t i = 0; i < work.size(); ++i) {
    const PatchFaceId q = work[i];
    if (!disc_.alive(q) || !disc_.removable(q) || !is_double(q)) continue;
    const PatchFace face = disc_.faces()[q];
    disc_.remove(q);
    ++removed;
    for (PatchFaceId across : face.neighbours)
      if (across.valid()) work.push_back(across);
  }
  if (removed > 0) disc_.close_slits();
  return removed;
}

std::size_t Growth::pad(PatchPoints& points) {
  const std::size_t count = disc_.faces().size();
  const IdVector<PatchFaceId, char> shown = this->shown(points);
  IdVector<PatchVertexId, char> near(disc_.vertex_count(), false);
  std::vector<PatchFaceId> work;
  for (PatchFaceId q : ids<PatchFaceId>(count)) {
    if (!disc_.alive(q)) continue;
    work.push_back(q);
    if (shown[q])
      for (PatchVertexId v : disc_.faces()[q].vertices) near[v] = true;
  }
  const auto touches = [&](PatchFaceId q) {
    const auto& v = disc_.faces()[q].vertices;
    return near[v[0]] || near[v[1]] || near[v[2]];
  };
  std::size_t changed = 0;
  for (std::size_t i = 0; i < work.size(); ++i) {
    const PatchFaceId q = work[i];
    if (!disc_.alive(q) || touches(q) || !disc_.removable(q)) continue;
    const PatchFace face = disc_.faces()[q];
    disc_.remove(q);
    ++changed;
    for (PatchFaceId across : face.neighbours)
      if (across.valid()) work.push_back(across);
  }
  note_cover();
  IdVector<PatchVertexId, char> inside(disc_.vertex_count(), false);
  near.resize(disc_.vertex_count(), false);
  for (PatchVertexId v : ids<PatchVertexId>(near.size())) {
    if (!near[v] || !disc_.alive(v)) continue;
    PatchVertexId at = v;
    while (const auto side = disc_.open_side(at)) {
      if (glue(side->face, side->edge, points, inside) != ImmersedDisc::Glue::glued) break;
      ++changed;
      at = disc_.survivor(at);
    }
  }
  return changed;
}

std::vector<Growth::Side> Growth::front(const PatchPoints& points,
                                        const IdVector<PatchVertexId, char>& inside,
                                        std::span<const PatchFaceId> candidates) const {
  std::vector<Side> front;
  for (PatchFaceId q : candidates) {
    if (!disc_.alive(q)) continue;
    const PatchFace& face = disc_.faces()[q];
    for (int k = 0; k < 3; ++k) {
      if (face.neighbours[k].valid()) continue;
      const PatchVertexId a = face.vertices[(k + 1) % 3], b = face.vertices[(k + 2) % 3];
      if (inside[a] || inside[b] || region_.meets_segment(points[a].image, points[b].image))
        front.push_back({q, k, 0.5 * (points[a].image + points[b].image)});
    }
  }
  std::sort(front.begin(), front.end(), [](const Side& a, const Side& b) {
    return std::pair(a.middle.real(), a.middle.imag()) < std::pair(b.middle.real(), b.middle.imag());
  });
  return front;
}

void Growth::note_cover() {
  over_.clear();
  if (cover_limit_ == 1) return;
  for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
    if (disc_.alive(q)) over_[disc_.faces()[q].mesh_face].push_back(q);
}

bool Growth::covered_nearby(FaceId f, const std::array<Vec2, 3>& image, const PatchPoints& points,
                            PatchFaceId self) const {
  const auto middle = [](const std::array<Vec2, 3>& z) { return (z[0] + z[1] + z[2]) / 3.0; };
  const auto width = [](const std::array<Vec2, 3>& z, Vec2 along) {
    const auto [least, most] = std::minmax({dot(z[0], along), dot(z[1], along), dot(z[2], along)});
    return most - least;
  };
  const auto over = over_.find(f);
  return over != over_.end() && std::any_of(over->second.begin(), over->second.end(), [&](PatchFaceId q) {
           if (q == self || !disc_.alive(q)) return false;
           const auto& v = disc_.faces()[q].vertices;
           const std::array<Vec2, 3> other = {points[v[0]].image, points[v[1]].image, points[v[2]].image};
           const Vec2 way = middle(other) - middle(image);
           const double distance = std::abs(way);
           if (distance <= near_share * region_.diameter()) return true;
           return distance <= near_widths * std::max(width(image, way), width(other, way)) / distance;
         });
}

/// Glues the face across edge k of q, which becomes the disc's last, and predicts its new vertex.
ImmersedDisc::Glue Growth::glue(PatchFaceId q, int k, PatchPoints& points,
                                IdVector<PatchVertexId, char>& inside) {
  const PatchFace face = disc_.faces()[q];
  const PatchPoint a = points[face.vertices[(k + 1) % 3]], b = points[face.vertices[(k + 2) % 3]];
  const BridgedSurface& surface = disc_.surface();
  const FaceId beyond = surface.neighbour(face.mesh_face, k);
  Vec2 apex = 0;  // of the face beyond, in the frame of the edge
  if (beyond.valid()) {
    const VertexId from = disc_.mesh_vertex(face.vertices[(k + 1) % 3]);
    const VertexId to = disc_.mesh_vertex(face.vertices[(k + 2) % 3]);
    const VertexId over = surface.vertices(beyond)[surface.neighbour_edge(face.mesh_face, k)];
    apex = apex_in_edge_frame(surface.position(from), surface.position(to), surface.position(over));
  }
  const PatchPoint predicted = {a.plane + (b.plane - a.plane) * apex, a.image + (b.image - a.image) * apex};
  if (beyond.valid() && cover_limit_ > 1 && disc_.cover(beyond) > 0 &&
      covered_nearby(beyond, {a.image, b.image, predicted.image}, points))
    return ImmersedDisc::Glue::covered;
  if (beyond.valid() && std::isfinite(most_area_)) {
    const double grown = area_ + area_of(surface, beyond);
    is_full_ = is_full_ || grown > most_area_;
    if (grown > most_area_) return ImmersedDisc::Glue::covered;
    area_ = grown;
  }
  const ImmersedDisc::GlueResult result = disc_.glue(q, k, cover_limit_);
  if (result.outcome != ImmersedDisc::Glue::glued) return result.outcome;
  if (cover_limit_ > 1) over_[beyond].push_back(result.face);
  const bool beside_inside = inside[face.vertices[(k + 1) % 3]] || inside[face.vertices[(k + 2) % 3]];
  points.resize(disc_.vertex_count());
  inside.resize(disc_.vertex_count(), false);
  if (result.merged) return result.outcome;
  points[result.vertex] = predicted;
  inside[result.vertex] = beside_inside && region_.contains(predicted.image);
  return result.outcome;
}

double Growth::area() const {
  double area = 0;
  for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
    if (disc_.alive(q)) area += area_of(disc_.surface(), disc_.faces()[q].mesh_face);
  return area;
}

std::size_t Growth::grow(PatchPoints& points, IdVector<PatchVertexId, char>& inside, double scale,
                         const Limits& limits) {
  const auto faces = static_cast<double>(disc_.live_faces());
  const auto most = static_cast<std::size_t>(limits.growth * faces);
  const int rings = std::max(limits.rings, static_cast<int>(limits.share * std::sqrt(faces)));
  note_cover();
  if (std::isfinite(most_area_)) area_ = area();
  std::vector<PatchFaceId> candidates;
  const IdVector<PatchFaceId, char> shown = this->shown(points);
  for (PatchFaceId q : ids<PatchFaceId>(shown.size())) {
    if (!disc_.alive(q)) continue;
    const auto& v = disc_.faces()[q].vertices;
    if (shown[q] || inside[v[0]] || inside[v[1]] || inside[v[2]]) candidates.push_back(q);
  }
  std::size_t added = 0;
  for (int ring = 0; ring < rings && disc_.live_faces() < most && !candidates.empty(); ++ring) {
    std::vector<PatchFaceId> fresh;
    for (const Side& side : front(points, inside, candidates)) {
      if (disc_.faces()[side.face].neighbours[side.edge].valid()) continue;  // zipped meanwhile
      ImmersedDisc::Glue outcome = glue(side.face, side.edge, points, inside);
      if (outcome == ImmersedDisc::Glue::boundary && bridge_hole(side.face, side.edge, scale))
        outcome = glue(side.face, side.edge, points, inside);
      if (outcome == ImmersedDisc::Glue::glued) fresh.emplace_back(disc_.faces().size() - 1);
    }
    added += fresh.size();
    candidates = std::move(fresh);
  }
  return added;
}

std::size_t Growth::fill_pockets(PatchPoints& points, IdVector<PatchVertexId, char>& inside, double scale) {
  note_cover();
  const BridgedSurface& surface = disc_.surface();
  const double longest_rim = longest_pocket_rim * region_.diameter() / scale;
  double most = 0;
  for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
    if (disc_.alive(q)) most += largest_pocket * area_of(surface, disc_.faces()[q].mesh_face);
  enum class Mark { pocket, open };
  std::unordered_map<FaceId, Mark> marks;
  const std::size_t count = disc_.faces().size();
  for (PatchFaceId q : ids<PatchFaceId>(count)) {
    if (!disc_.alive(q)) continue;
    for (int k = 0; k < 3; ++k) {
      const PatchFace& face = disc_.faces()[q];
      const FaceId start = surface.neighbour(face.mesh_face, k);
      if (face.neighbours[k].valid() || !start.valid() || disc_.cover(start) > 0 || marks.contains(start))
        continue;
      // Flood the uncovered faces; the part is a pocket if the flood ends soon and its rim is short.
      std::vector<FaceId> part = {start};
      marks[start] = Mark::pocket;
      double rim = 0, area = 0;
      bool open = false;
      for (std::size_t i = 0; i < part.size() && !open; ++i) {
        for (int e = 0; e < 3 && !open; ++e) {
          const FaceId next = surface.neighbour(part[i], e);
          if (!next.valid()) {
            open = true;
          } else if (disc_.cover(next) > 0) {
            const auto& v = surface.vertices(part[i]);
            rim += (surface.position(v[(e + 2) % 3]) - surface.position(v[(e + 1) % 3])).norm();
          } else if (const auto [mark, is_new] = marks.try_emplace(next, Mark::pocket); is_new) {
            part.push_back(next);
          } else {
            open = mark->second == Mark::open;
          }
        }
        area += area_of(surface, part[i]);
        open = open || area > most || rim > longest_rim;
      }
      if (open)
        for (FaceId f : part) marks[f] = Mark::open;
    }
  }
  // Glue into the pockets only, ring by ring.
  std::size_t added = 0;
  for (PatchFaceId q(0); q.value < disc_.faces().size(); ++q.value) {
    if (!disc_.alive(q)) continue;
    for (int k = 0; k < 3; ++k) {
      const PatchFace& face = disc_.faces()[q];
      const FaceId beyond = surface.neighbour(face.mesh_face, k);
      if (face.neighbours[k].valid() || !beyond.valid()) continue;
      const auto mark = marks.find(beyond);
      if (mark == marks.end() || mark->second == Mark::open) continue;
      added += glue(q, k, points, inside) == ImmersedDisc::Glue::glued;
    }
  }
  return added;
}

bool Growth::bridge_hole(PatchFaceId q, int k, double scale) {
  const auto hole = disc_.surface().hole_at(disc_.faces()[q].mesh_face, k, most_hole_sides);
  if (!hole) return false;
  if (!(hole->perimeter * scale < largest_hole * region_.diameter())) return false;
  disc_.surface().bridge(*hole);
  return true;
}

void Growth::compact(PatchPoints& points) {
  const ImmersedDisc::Renumbering map = disc_.compact();
  PatchPoints compacted(disc_.vertex_count());
  for (PatchVertexId v : ids<PatchVertexId>(map.vertices.size()))
    if (map.vertices[v].valid()) compacted[map.vertices[v]] = points[v];
  points = std::move(compacted);
  for (PatchFaceId& q : feature_faces_) q = map.faces[q];
}

Coverage Growth::coverage(const PatchPoints& points) const {
  Coverage worst = Coverage::covered;
  const IdVector<PatchFaceId, char> shown = this->shown(points);
  for (PatchFaceId q : ids<PatchFaceId>(shown.size())) {
    if (!disc_.alive(q) || !shown[q]) continue;
    const PatchFace& face = disc_.faces()[q];
    for (int k = 0; k < 3; ++k) {
      if (face.neighbours[k].valid()) continue;
      const PatchVertexId a = face.vertices[(k + 1) % 3], b = face.vertices[(k + 2) % 3];
      if (!region_.meets_segment(points[a].image, points[b].image)) continue;
      const FaceId beyond = disc_.surface().neighbour(face.mesh_face, k);
      const Coverage here = !beyond.valid()                            ? Coverage::clipped_by_boundary
                            : disc_.cover(beyond) > 0                  ? Coverage::clipped_by_cover
                            : is_full_ || disc_.boundary_length() <= 3 ? Coverage::clipped_closed
                                                                       : Coverage::not_converged;
      worst = std::max(worst, here);
    }
  }
  return worst;
}

}  // namespace applique
