#include "applique/surface/bridged_surface.h"

namespace applique {
namespace {

std::uint64_t side_key(FaceId f, int k) {
  return 4 * std::uint64_t{f.value} + static_cast<std::uint64_t>(k);
}

}  // namespace

BridgedSurface::Side BridgedSurface::side(FaceId f, int k) const {
  if (is_bridge(f)) return bridges_[f.value - mesh_->faces.size()].across[k];
  const FaceId g = mesh_->neighbours[f][k];
  if (g.valid() || rim_.empty()) return {g, mesh_->neighbour_edges[f][k]};
  const auto found = rim_.find(side_key(f, k));
  return found == rim_.end() ? Side{} : found->second;
}

std::uint32_t BridgedSurface::degree(VertexId v) const {
  if (is_bridge(v)) return centres_[v.value - mesh_->positions.size()].degree;
  if (rim_degree_.empty()) return mesh_->degree[v];
  const auto found = rim_degree_.find(v);
  return mesh_->degree[v] + (found == rim_degree_.end() ? 0 : found->second);
}

std::optional<BridgedSurface::Hole> BridgedSurface::hole_at(FaceId f, int k, std::size_t max_sides) const {
  Hole hole;
  Side at{f, k};
  do {
    if (hole.sides.size() == max_sides) return std::nullopt;
    hole.sides.push_back(at);
    const auto& v = vertices(at.face);
    hole.perimeter += (position(v[(at.edge + 2) % 3]) - position(v[(at.edge + 1) % 3])).norm();
    // The next side starts where this one ends: rotate round that vertex, crossing faces, to the boundary.
    int edge = (at.edge + 1) % 3;
    FaceId face = at.face;
    while (neighbour(face, edge).valid()) {
      const Side next = side(face, edge);
      face = next.face;
      edge = (next.edge + 1) % 3;
    }
    at = {face, edge};
  } while (at.face != f || at.edge != k);
  return hole;
}

void BridgedSurface::bridge(const Hole& hole) {
  const std::size_t n = hole.sides.size();
  const VertexId centre(mesh_->positions.size() + centres_.size());
  const std::size_t first = mesh_->faces.size() + bridges_.size();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const auto [face, edge] = hole.sides[i];
    const auto& v = vertices(face);
    const VertexId from = v[(edge + 1) % 3], to = v[(edge + 2) % 3];
    sum += position(from);
    const FaceId self(first + i), previous(first + (i + n - 1) % n), next(first + (i + 1) % n);
    // The bridge runs the rim's side backwards, so that the two agree in orientation.
    bridges_.push_back({{centre, to, from}, {Side{face, edge}, Side{previous, 2}, Side{next, 1}}});
    rim_[side_key(face, edge)] = {self, 0};
    rim_degree_[from] += 2;
  }
  centres_.push_back({sum / static_cast<double>(n), static_cast<std::uint32_t>(n)});
}

}  // namespace applique
