#include "applique/paper/graph_paths.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>

#include <fmt/format.h>

#include "applique/decal_input.h"
#include "applique/surface/shortest_path.h"

namespace applique {
namespace {

constexpr double longest_detour = 1.25;  // times the shortest path, and two edges more
constexpr double noticeable_snap = 0.1;  // of the face's longest edge

SurfacePoint point_at(const SurfaceMesh& surface, VertexId v) {
  SurfacePoint point{surface.vertex_face[v], {0, 0, 0}};
  const auto& corners = surface.faces[point.face];
  point
      .barycentric[static_cast<std::size_t>(std::find(corners.begin(), corners.end(), v) - corners.begin())] =
      1;
  return point;
}

double length_of(const SurfaceMesh& surface, const std::vector<VertexId>& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += (surface.positions[path[i]] - surface.positions[path[i - 1]]).norm();
  return length;
}

/// What a path may be longer than the shortest one.
double allowed_length(const SurfaceMesh& surface, const std::vector<VertexId>& shortest) {
  const double length = length_of(surface, shortest);
  return longest_detour * length + 2 * length / static_cast<double>(shortest.size() - 1);
}

/// A shortest path between two vertices, both included.
std::vector<VertexId> path_between(const SurfaceMesh& surface, VertexId from, VertexId to,
                                   std::unordered_set<VertexId> blocked) {
  blocked.erase(from);
  blocked.erase(to);
  std::vector<VertexId> path =
      shortest_path(surface, point_at(surface, from), point_at(surface, to), blocked);
  if (path.empty()) return path;
  // A neighbour in the same face is as near an end as the vertex itself.
  if (path.front() != from) path.insert(path.begin(), from);
  if (path.back() != to) path.push_back(to);
  return path;
}

/// By edge of the graph, the edges that share a face with it.
std::vector<std::vector<std::size_t>> edges_in_common_faces(const ConvexGraph& graph) {
  std::vector<std::vector<std::size_t>> common(graph.edges.size());
  for (const auto& face : graph.faces) {
    std::vector<std::size_t> edges;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto [a, b] = std::minmax(face[i], face[(i + 1) % face.size()]);
      const auto edge = std::lower_bound(graph.edges.begin(), graph.edges.end(), FeaturePair{a, b});
      edges.push_back(static_cast<std::size_t>(edge - graph.edges.begin()));
    }
    for (std::size_t e : edges)
      for (std::size_t other : edges)
        if (other != e) common[e].push_back(other);
  }
  return common;
}

}  // namespace

std::string feature_list(const std::vector<std::uint32_t>& features) {
  std::string text = features.size() == 1 ? "feature " : "features ";
  for (std::size_t i = 0; i < features.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 == features.size() ? " and " : ", ", features[i]);
  return text;
}

std::string ask_for_feature(const DecalInput& input, Vec2 place) {
  const Pixel at = input.region.frame().to_pixel(place);
  return fmt::format("the paper's method wants another feature near ({:.1f}, {:.1f}) in the image", at.x,
                     at.y);
}

Result<std::vector<VertexFeature>> snap_features(const SurfaceMesh& surface, const DecalInput& input,
                                                 std::vector<Warning>& warnings) {
  std::vector<VertexFeature> features;
  for (std::size_t k = 0; k < input.features.size(); ++k) {
    const SurfacePoint& point = input.features[k].surface;
    const Vec3 place = position_of(surface, point);
    const auto corners = surface.corners(point.face);
    std::size_t nearest = 0;
    double longest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if ((corners[c] - place).norm() < (corners[nearest] - place).norm()) nearest = c;
      longest = std::max(longest, (corners[(c + 1) % 3] - corners[c]).norm());
    }
    const VertexId vertex = surface.faces[point.face][nearest];
    for (std::size_t j = 0; j < k; ++j)
      if (features[j].vertex == vertex)
        return fail(ErrorCode::not_solved,
                    fmt::format("decal '{}': {} and {} are nearest to the same vertex of the model; the "
                                "paper's method pins vertices, so move one of them, or leave it out",
                                input.name, feature_name(input, j), feature_name(input, k)));
    const double moved = (corners[nearest] - place).norm();
    if (moved > noticeable_snap * longest)
      warnings.push_back({"feature_snapped",
                          fmt::format("decal '{}': {} is moved to the nearest vertex, {:.4g} away, because "
                                      "the paper's method pins vertices",
                                      input.name, feature_name(input, k), moved)});
    features.push_back({vertex, input.region.frame().to_plane(input.features[k].image)});
  }
  return features;
}

Result<GraphPaths> trace_graph_paths(const SurfaceMesh& surface, const DecalInput& input,
                                     const std::vector<VertexFeature>& features, const ConvexGraph& graph) {
  std::unordered_set<VertexId> feature_vertices;
  for (const VertexFeature& feature : features) feature_vertices.insert(feature.vertex);
  GraphPaths paths;
  for (const auto& [i, j] : graph.edges) {
    paths.push_back(path_between(surface, features[i].vertex, features[j].vertex, feature_vertices));
    if (paths.back().empty())
      return fail(ErrorCode::features_disconnected,
                  fmt::format("decal '{}': no way along the surface from {} to {}", input.name,
                              feature_name(input, i), feature_name(input, j)));
  }

  // Shortest first, so that it is the longer of two paths that goes round.
  std::vector<std::size_t> order(paths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return length_of(surface, paths[a]) < length_of(surface, paths[b]);
  });
  const auto common = edges_in_common_faces(graph);
  std::vector<char> settled(paths.size(), false);
  for (std::size_t e : order) {
    std::unordered_set<VertexId> blocked = feature_vertices;
    for (std::size_t other : common[e])
      if (settled[other]) blocked.insert(paths[other].begin(), paths[other].end());
    const auto [i, j] = graph.edges[e];
    std::vector<VertexId> path = path_between(surface, features[i].vertex, features[j].vertex, blocked);
    if (path.empty() || length_of(surface, path) > allowed_length(surface, paths[e])) {
      const auto crossed = std::find_if(common[e].begin(), common[e].end(), [&](std::size_t other) {
        return settled[other] &&
               std::find_first_of(paths[e].begin() + 1, paths[e].end() - 1, paths[other].begin(),
                                  paths[other].end()) != paths[e].end() - 1;
      });
      APPLIQUE_ASSERT(crossed != common[e].end());
      const auto [k, l] = graph.edges[*crossed];
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': on the surface the path from {} to {} crosses the one from {} to "
                              "{}, which bounds the same face: {}",
                              input.name, feature_name(input, i), feature_name(input, j),
                              feature_name(input, k), feature_name(input, l),
                              ask_for_feature(input, 0.5 * (features[i].target + features[j].target))));
    }
    paths[e] = std::move(path);
    settled[e] = true;
  }
  return paths;
}

}  // namespace applique
