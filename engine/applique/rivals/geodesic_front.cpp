#include "applique/rivals/geodesic_front.h"

#include <algorithm>
#include <unordered_set>

namespace applique {
namespace {

/// Calls visit(w) for each neighbour of v, once.
template <class Visit>
void for_each_neighbour(const SurfaceMesh& mesh, VertexId v, Visit visit) {
  for_each_face(mesh, v, [&](FaceId f) {
    const auto& corners = mesh.faces[f];
    const int k = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
    visit(corners[(k + 1) % 3]);
    // The other neighbour is seen from the next face, if there is one.
    if (!mesh.neighbours[f][(k + 1) % 3].valid()) visit(corners[(k + 2) % 3]);
  });
}

}  // namespace

void GeodesicFront::start(VertexId v, double distance, Vec2 at, const Vec3& axis, const Vec3& normal) {
  Vertex& vertex = vertices_[v];
  if (vertex.distance <= distance) return;
  vertex = {distance, {}, axes_.size(), at};
  axes_.push_back({axis, normal});
  queue_.push({distance, v});
}

void GeodesicFront::reach(const std::vector<Feature>& features) {
  for (const Feature& feature : features)
    for (VertexId corner : surface_.faces[feature.surface.face])
      while (!settled(corner)) {
        const auto v = settle();
        APPLIQUE_ASSERT(v.has_value());
        expand(*v);
      }
}

Vec2 GeodesicFront::image_of(const SurfacePoint& point, const ToImage& to_image) const {
  Vec2 z = 0;
  for (int k = 0; k < 3; ++k)
    z += point.barycentric[k] * to_image(vertices_.at(surface_.faces[point.face][k]).at);
  return z;
}

RivalMap GeodesicFront::cover(const RegionBox& box, const ToImage& to_image) {
  RivalMap map;
  std::unordered_set<FaceId> seen;
  const auto note = [&](VertexId v) {
    map.image[v] = to_image(vertices_.at(v).at);
    for_each_face(surface_, v, [&](FaceId f) {
      const auto& corners = surface_.faces[f];
      if (std::all_of(corners.begin(), corners.end(), [&](VertexId w) { return map.image.contains(w); }) &&
          seen.insert(f).second)
        map.faces.push_back(f);
    });
  };
  for (VertexId v : order_) note(v);
  while (const auto settled_now = settle()) {
    const VertexId v = *settled_now;
    note(v);
    // Faces beyond an edge that meets the box may meet the region.
    if (box.meets({map.image[v]})) expand(v);
    for_each_neighbour(surface_, v, [&](VertexId w) {
      if (!map.image.contains(w) || !box.meets({map.image[v], map.image[w]})) return;
      expand(v);
      expand(w);
    });
  }
  return map;
}

bool GeodesicFront::settled(VertexId v) const {
  const auto found = vertices_.find(v);
  return found != vertices_.end() && found->second.settled;
}

/// The nearest vertex that is not settled, settled now.
std::optional<VertexId> GeodesicFront::settle() {
  while (!queue_.empty()) {
    const Candidate next = queue_.top();
    queue_.pop();
    Vertex& vertex = vertices_.at(next.vertex);
    if (vertex.settled) continue;
    vertex.settled = true;
    if (vertex.parent.valid()) take_coordinates(next.vertex, vertex);
    vertex.normal = vertex_normal(surface_, next.vertex);
    vertex.axis = transport(axes_[vertex.axes].axis, axes_[vertex.axes].normal, vertex.normal);
    order_.push_back(next.vertex);
    return next.vertex;
  }
  return std::nullopt;
}

/// Brings the neighbours of a settled vertex into the queue.
void GeodesicFront::expand(VertexId v) {
  Vertex& from = vertices_.at(v);
  if (from.expanded) return;
  from.expanded = true;
  const Vertex reached_from_here = {from.distance, v, from.axes};
  for_each_neighbour(surface_, v, [&](VertexId w) {
    Vertex reached = reached_from_here;
    reached.distance += (surface_.positions[w] - surface_.positions[v]).norm();
    const auto [entry, fresh] = vertices_.try_emplace(w, reached);
    if (!fresh) {
      const Vertex& known = entry->second;
      // A start keeps its coordinates, which are exact.
      if (known.settled || !known.parent.valid() || known.distance <= reached.distance) return;
      entry->second = reached;
    }
    queue_.push({reached.distance, w});
  });
}

void GeodesicFront::take_coordinates(VertexId r, Vertex& vertex) {
  double total = 0;
  const auto take = [&](VertexId q) {
    const Vertex& from = vertices_.at(q);
    const Vec3 edge = surface_.positions[r] - surface_.positions[q];
    const Vec2 flat(edge.dot(from.axis), edge.dot(from.normal.cross(from.axis)));
    const double stretch = std::abs(flat) > 0 ? edge.norm() / std::abs(flat) : 0;
    const double weight = 1 / edge.squaredNorm();
    vertex.at += weight * (from.at + stretch * flat);
    total += weight;
  };
  if (parents_ == Parents::one)
    take(vertex.parent);
  else
    for_each_neighbour(surface_, r, [&](VertexId q) {
      if (settled(q)) take(q);
    });
  vertex.at /= total;
}

}  // namespace applique
