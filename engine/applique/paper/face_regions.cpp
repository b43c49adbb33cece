#include "applique/paper/face_regions.h"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "applique/decal_input.h"

namespace applique {
namespace {

constexpr double largest_region = 8;  // times the area expected from the paths' lengths

using Cycle = std::vector<VertexId>;

std::uint64_t edge_key(VertexId a, VertexId b) {
  return std::uint64_t{std::min(a, b).value} << 32 | std::max(a, b).value;
}

/// The paths of a face one after the other, counter-clockwise.
Cycle cycle_of(const std::vector<std::uint32_t>& face, const ConvexGraph& graph, const GraphPaths& paths) {
  Cycle cycle;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const std::uint32_t from = face[i], to = face[(i + 1) % face.size()];
    const auto edge = std::lower_bound(graph.edges.begin(), graph.edges.end(),
                                       FeaturePair{std::min(from, to), std::max(from, to)});
    const auto& path = paths[static_cast<std::size_t>(edge - graph.edges.begin())];
    if (from < to)
      cycle.insert(cycle.end(), path.begin(), path.end() - 1);
    else
      cycle.insert(cycle.end(), path.rbegin(), path.rend() - 1);
  }
  return cycle;
}

/// The face to the left of the edge a -> b; invalid at the surface's boundary.
FaceId left_face(const SurfaceMesh& surface, VertexId a, VertexId b) {
  const FaceId first = surface.vertex_face[a];
  for (int way = 0; way < 2; ++way) {
    FaceId f = first;
    do {
      const auto& corners = surface.faces[f];
      const int c = corners[0] == a ? 0 : corners[1] == a ? 1 : 2;
      if (corners[(c + 1) % 3] == b) return f;
      f = surface.neighbours[f][way == 0 ? (c + 2) % 3 : (c + 1) % 3];
    } while (f.valid() && f != first);
  }
  return {};
}

double area_of(const SurfaceMesh& surface, FaceId f) {
  const auto c = surface.corners(f);
  return 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
}

/// The area that the paths' lengths let expect: the face in the image, as much larger as its outline is.
double expected_area(const SurfaceMesh& surface, const std::vector<VertexFeature>& features,
                     const std::vector<std::uint32_t>& face, const Cycle& cycle) {
  double area = 0, rim = 0, surface_rim = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec2 a = features[face[i]].target, b = features[face[(i + 1) % face.size()]].target;
    area += 0.5 * cross(a, b);
    rim += std::abs(b - a);
  }
  for (std::size_t i = 0; i < cycle.size(); ++i)
    surface_rim += (surface.positions[cycle[(i + 1) % cycle.size()]] - surface.positions[cycle[i]]).norm();
  // A sliver in the image need not be one on the surface.
  return std::max(area, 0.01 * rim * rim) * (surface_rim / rim) * (surface_rim / rim);
}

/// What the flood reaches from the cycle's left; empty when it becomes larger than `most` or leaks.
std::vector<FaceId> flood(const SurfaceMesh& surface, const Cycle& cycle, double most) {
  std::unordered_set<std::uint64_t> walls;
  std::unordered_set<FaceId> right;
  std::vector<FaceId> region;
  std::unordered_set<FaceId> reached;
  const auto reach = [&](FaceId f) {
    if (f.valid() && reached.insert(f).second) region.push_back(f);
  };
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const VertexId a = cycle[i], b = cycle[(i + 1) % cycle.size()];
    walls.insert(edge_key(a, b));
    reach(left_face(surface, a, b));
    right.insert(left_face(surface, b, a));
  }
  double area = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    const FaceId f = region[i];
    area += area_of(surface, f);
    if (area > most || right.contains(f)) return {};
    for (int k = 0; k < 3; ++k)
      if (!walls.contains(edge_key(surface.faces[f][(k + 1) % 3], surface.faces[f][(k + 2) % 3])))
        reach(surface.neighbours[f][k]);
  }
  return region;
}

bool is_disc(const SurfaceMesh& surface, const std::vector<FaceId>& region, const Cycle& cycle) {
  std::unordered_set<VertexId> vertices;
  std::unordered_map<std::uint64_t, int> edges;
  for (FaceId f : region)
    for (int k = 0; k < 3; ++k) {
      vertices.insert(surface.faces[f][k]);
      ++edges[edge_key(surface.faces[f][(k + 1) % 3], surface.faces[f][(k + 2) % 3])];
    }
  const auto rim =
      std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 1; });
  return vertices.size() + region.size() == edges.size() + 1 && static_cast<std::size_t>(rim) == cycle.size();
}

/// The middle of the face's edge that is nearest to z.
Vec2 nearest_edge_middle(const std::vector<VertexFeature>& features, const std::vector<std::uint32_t>& face,
                         Vec2 z) {
  Vec2 best = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec2 middle = 0.5 * (features[face[i]].target + features[face[(i + 1) % face.size()]].target);
    if (i == 0 || std::abs(middle - z) < std::abs(best - z)) best = middle;
  }
  return best;
}

}  // namespace

Result<std::vector<std::vector<FaceId>>> find_face_regions(const SurfaceMesh& surface,
                                                           const DecalInput& input,
                                                           const std::vector<VertexFeature>& features,
                                                           const ConvexGraph& graph,
                                                           const GraphPaths& paths) {
  std::vector<std::vector<FaceId>> regions;
  std::vector<Cycle> cycles;
  for (const auto& face : graph.faces) {
    cycles.push_back(cycle_of(face, graph, paths));
    const Cycle& cycle = cycles.back();
    regions.push_back(flood(surface, cycle, largest_region * expected_area(surface, features, face, cycle)));
    if (!regions.back().empty() && is_disc(surface, regions.back(), cycle)) continue;
    Vec2 middle = 0;
    for (std::uint32_t k : face) middle += features[k].target / static_cast<double>(face.size());
    return fail(ErrorCode::not_solved,
                fmt::format("decal '{}': the paths between {} bound no piece of the surface that could be "
                            "their face: check that they run the same way round in the image and on the "
                            "surface; if they do, {}",
                            input.name, feature_list(face), ask_for_feature(input, middle)));
  }
  for (const auto& [k, face] : graph.isolated) {
    const Cycle& cycle = cycles[face];
    const VertexId vertex = features[k].vertex;
    const bool inside = std::find(cycle.begin(), cycle.end(), vertex) == cycle.end() &&
                        std::any_of(regions[face].begin(), regions[face].end(), [&](FaceId f) {
                          const auto& corners = surface.faces[f];
                          return std::find(corners.begin(), corners.end(), vertex) != corners.end();
                        });
    if (inside) continue;
    return fail(
        ErrorCode::not_solved,
        fmt::format(
            "decal '{}': {} lies inside the face of {} in the image, but outside it on the surface: {}",
            input.name, feature_name(input, k), feature_list(graph.faces[face]),
            ask_for_feature(input, nearest_edge_middle(features, graph.faces[face], features[k].target))));
  }
  return regions;
}

}  // namespace applique
