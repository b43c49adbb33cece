#include "applique/surface/shortest_path.h"

#include <algorithm>
#include <queue>
#include <unordered_map>

namespace applique {
namespace {

struct Candidate {
  double bound;  ///< Distance so far plus the straight distance to the target.
  VertexId vertex;
  bool operator>(const Candidate& other) const {
    return std::tie(bound, vertex) > std::tie(other.bound, other.vertex);
  }
};

struct Reached {
  double distance;
  VertexId previous;
  bool settled = false;
};

}  // namespace

std::vector<VertexId> shortest_path(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                    const std::unordered_set<VertexId>& blocked) {
  if (mesh.component[mesh.faces[from.face][0]] != mesh.component[mesh.faces[to.face][0]]) return {};
  const Vec3 start = position_of(mesh, from), goal = position_of(mesh, to);
  std::unordered_map<VertexId, Reached> reached;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  const auto reach = [&](VertexId v, VertexId previous, double distance) {
    if (blocked.contains(v)) return;
    const auto [entry, is_new] = reached.try_emplace(v, Reached{distance, previous});
    if (!is_new) {
      if (entry->second.settled || entry->second.distance <= distance) return;
      entry->second = {distance, previous};
    }
    queue.push({distance + (mesh.positions[v] - goal).norm(), v});
  };
  for (VertexId v : mesh.faces[from.face]) reach(v, VertexId(), (mesh.positions[v] - start).norm());

  const auto& ends = mesh.faces[to.face];
  double best = std::numeric_limits<double>::infinity();
  VertexId end;
  while (!queue.empty()) {
    const Candidate candidate = queue.top();
    queue.pop();
    if (candidate.bound >= best) break;
    Reached& at = reached.at(candidate.vertex);
    if (at.settled) continue;
    at.settled = true;
    const double distance = at.distance;
    const VertexId v = candidate.vertex;
    if (std::find(ends.begin(), ends.end(), v) != ends.end()) {
      const double total = distance + (mesh.positions[v] - goal).norm();
      if (total < best) {
        best = total;
        end = v;
      }
    }
    for_each_face(mesh, v, [&](FaceId f) {
      for (VertexId w : mesh.faces[f])
        if (w != v) reach(w, v, distance + (mesh.positions[w] - mesh.positions[v]).norm());
    });
  }
  std::vector<VertexId> path;
  for (VertexId v = end; v.valid(); v = reached.at(v).previous) path.push_back(v);
  std::reverse(path.begin(), path.end());
  return path;
}

std::optional<double> way_length(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to) {
  const std::vector<VertexId> path = shortest_path(mesh, from, to);
  if (path.empty()) return std::nullopt;
  Vec3 last = position_of(mesh, from);
  double length = (mesh.positions[path.back()] - position_of(mesh, to)).norm();
  for (const VertexId v : path) {
    length += (mesh.positions[v] - last).norm();
    last = mesh.positions[v];
  }
  return length;
}

}  // namespace applique
