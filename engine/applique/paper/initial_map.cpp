#include "applique/paper/initial_map.h"

#include "applique/embed/mean_value.h"
#include "applique/paper/continue_map.h"

namespace applique {
namespace {

/// Spreads a path's vertices between its ends, which are placed.
void spread_path(const PaperSeed& seed, const FeaturePair& edge, const std::vector<VertexId>& path,
                 std::vector<char>& placed, std::vector<Vec2>& map) {
  const ImmersedDisc& disc = seed.disc;
  std::vector<PatchVertexId> vertices = {seed.features[edge[0]]};
  std::vector<double> along = {0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const PatchVertexId next = disc.neighbour_over(vertices.back(), path[i]);
    if (!next.valid()) return;  // a bridging path that another has carried its feature in place of
    along.push_back(along.back() + (disc.position(next) - disc.position(vertices.back())).norm());
    vertices.push_back(next);
  }
  const Vec2 from = map[seed.features[edge[0]].value], to = map[seed.features[edge[1]].value];
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    if (placed[vertices[i].value]) continue;
    map[vertices[i].value] = from + (along[i] / along.back()) * (to - from);
    placed[vertices[i].value] = true;
  }
}

}  // namespace

std::vector<Vec2> map_seed(const PaperSeed& seed, const std::vector<VertexFeature>& features,
                           const ConvexGraph& graph, const GraphPaths& paths) {
  const std::size_t count = seed.disc.vertex_count();
  std::vector<Vec2> map(count);
  std::vector<char> placed(count, false);
  for (std::size_t k = 0; k < features.size(); ++k) {
    map[seed.features[k].value] = features[k].target;
    placed[seed.features[k].value] = true;
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e)
    spread_path(seed, graph.edges[e], paths[e], placed, map);

  std::vector<char> free(count, false);
  for (const auto& sheet : seed.sheets)
    for (PatchFaceId q : sheet)
      for (PatchVertexId v : seed.disc.faces()[q].vertices) free[v.value] = !placed[v.value];
  place_by_mean_value(measure_disc(seed.disc), free, map);
  for (std::size_t v = 0; v < count; ++v) placed[v] = placed[v] || free[v];
  continue_map(seed.disc, placed, map);
  return map;
}

}  // namespace applique
