#include "applique/paper/paper_seed.h"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "applique/decal_input.h"

namespace applique {
namespace {

constexpr std::uint32_t one_sheet = 1;
constexpr std::uint32_t any_sheets = std::numeric_limits<std::uint32_t>::max();

class Builder {
 public:
  Builder(BridgedSurface& surface, const DecalInput& input, const std::vector<VertexFeature>& features,
          const ConvexGraph& graph, const GraphPaths& paths, const std::vector<std::vector<FaceId>>& regions)
      : input_(input),
        features_(features),
        graph_(graph),
        paths_(paths),
        regions_(regions),
        start_(first_on_graph(graph)),
        seed_{ImmersedDisc(surface, surface.mesh().vertex_face[features[start_].vertex]),
              std::vector<PatchVertexId>(features.size()),
              std::vector<std::vector<PatchFaceId>>(graph.faces.size())} {}

  /// Breadth first from a feature: the faces and the bridges at each feature that has been placed.
  Result<PaperSeed> run() {
    place(start_, corner_over(PatchFaceId(0), features_[start_].vertex));
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::uint32_t k = queue_[i];
      seed_.features[k] = seed_.disc.complete_fan(at(k), one_sheet);
      for (std::size_t face = 0; face < graph_.faces.size(); ++face)
        if (seed_.sheets[face].empty() && contains(graph_.faces[face], k)) APPLIQUE_CHECK(lay_face(face, k));
      for (const FeaturePair& bridge : graph_.bridges) {
        if (bridge[0] != k && bridge[1] != k) continue;
        const std::uint32_t end = bridge[0] == k ? bridge[1] : bridge[0];
        if (!seed_.features[end].valid()) APPLIQUE_CHECK(lay_bridge(bridge, k, end));
      }
    }
    for (std::uint32_t k = 0; k < features_.size(); ++k)
      if (!seed_.features[k].valid())
        return fail(
            ErrorCode::not_solved,
            fmt::format("decal '{}': the faces and paths of the graph do not reach {} on the surface: {}",
                        input_.name, feature_name(input_, k),
                        ask_for_feature(input_, 0.5 * (features_[start_].target + features_[k].target))));
    return compacted();
  }

 private:
  /// An isolated feature leads nowhere; its face leads to it.
  [[nodiscard]] static std::uint32_t first_on_graph(const ConvexGraph& graph) {
    std::uint32_t k = 0;
    const auto is_isolated = [&](const ConvexGraph::Isolated& isolated) { return isolated.feature == k; };
    while (std::any_of(graph.isolated.begin(), graph.isolated.end(), is_isolated)) ++k;
    return k;
  }
  [[nodiscard]] static bool contains(const std::vector<std::uint32_t>& face, std::uint32_t k) {
    return std::find(face.begin(), face.end(), k) != face.end();
  }
  [[nodiscard]] PatchVertexId at(std::uint32_t k) const { return seed_.disc.survivor(seed_.features[k]); }
  [[nodiscard]] PatchVertexId corner_over(PatchFaceId q, VertexId vertex) const {
    for (PatchVertexId v : seed_.disc.faces()[q].vertices)
      if (seed_.disc.mesh_vertex(v) == vertex) return v;
    return {};
  }

  void place(std::uint32_t k, PatchVertexId v) {
    if (seed_.features[k].valid()) return;
    seed_.features[k] = v;
    queue_.push_back(k);
  }

  /// Covers a face's region from feature k on with one sheet.
  Result<void> lay_face(std::size_t face, std::uint32_t k) {
    const std::unordered_set<FaceId> region(regions_[face].begin(), regions_[face].end());
    std::unordered_set<FaceId> covered;
    std::vector<PatchFaceId>& sheet = seed_.sheets[face];
    const auto add = [&](PatchFaceId q) {
      const FaceId over = seed_.disc.faces()[q].mesh_face;
      if (region.contains(over) && covered.insert(over).second) sheet.push_back(q);
    };
    for (PatchFaceId q : seed_.disc.fan(at(k))) add(q);
    if (sheet.empty()) {
      seed_.features[k] = seed_.disc.complete_fan(at(k), any_sheets);
      for (PatchFaceId q : seed_.disc.fan(at(k))) add(q);
    }
    // What is there already belongs to the sheet; only then is a face glued, and again what it is joined to.
    std::size_t spread = 0, glued = 0;
    while (glued < sheet.size()) {
      for (; spread < sheet.size(); ++spread)
        for (PatchFaceId across : seed_.disc.faces()[sheet[spread]].neighbours)
          if (across.valid()) add(across);
      const PatchFaceId added = glue_into(region, covered, sheet[glued]);
      if (added.valid())
        add(added);
      else
        ++glued;
    }
    if (covered.size() < region.size())
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': no room on the surface for the face of {} beside the others",
                              input_.name, feature_list(graph_.faces[face])));
    for (std::uint32_t j : graph_.faces[face]) place_in(sheet, j);
    for (const auto& [feature, in] : graph_.isolated)
      if (in == face) place_in(sheet, feature);
    return {};
  }

  /// Glues one face of the region that is not covered yet to q; returns it, or an invalid id.
  PatchFaceId glue_into(const std::unordered_set<FaceId>& region, const std::unordered_set<FaceId>& covered,
                        PatchFaceId q) {
    ImmersedDisc& disc = seed_.disc;
    for (int k = 0; k < 3; ++k) {
      if (disc.faces()[q].neighbours[k].valid()) continue;
      const FaceId beyond = disc.surface().neighbour(disc.faces()[q].mesh_face, k);
      if (!beyond.valid() || !region.contains(beyond) || covered.contains(beyond)) continue;
      const ImmersedDisc::GlueResult result = disc.glue(q, k, any_sheets);
      if (result.outcome == ImmersedDisc::Glue::glued) return result.face;
    }
    return {};
  }

  void place_in(const std::vector<PatchFaceId>& sheet, std::uint32_t k) {
    for (PatchFaceId q : sheet)
      if (const PatchVertexId v = corner_over(q, features_[k].vertex); v.valid()) return place(k, v);
  }

  /// Covers what is along a bridging path, on a sheet of its own where that is needed to go on.
  Result<void> lay_bridge(const FeaturePair& bridge, std::uint32_t from, std::uint32_t to) {
    const auto edge = std::lower_bound(graph_.edges.begin(), graph_.edges.end(), bridge);
    std::vector<VertexId> path = paths_[static_cast<std::size_t>(edge - graph_.edges.begin())];
    if (from != bridge[0]) std::reverse(path.begin(), path.end());
    PatchVertexId v = at(from);
    for (std::size_t i = 1; i < path.size(); ++i) {
      v = seed_.disc.complete_fan(v, one_sheet);
      PatchVertexId next = seed_.disc.neighbour_over(v, path[i]);
      if (!next.valid()) {
        v = seed_.disc.complete_fan(v, any_sheets);
        next = seed_.disc.neighbour_over(v, path[i]);
      }
      if (!next.valid())
        return fail(
            ErrorCode::not_solved,
            fmt::format("decal '{}': no room on the surface for the path from {} to {}: {}", input_.name,
                        feature_name(input_, from), feature_name(input_, to),
                        ask_for_feature(input_, 0.5 * (features_[from].target + features_[to].target))));
      v = next;
    }
    place(to, v);
    return {};
  }

  PaperSeed compacted() {
    for (std::uint32_t k = 0; k < features_.size(); ++k) seed_.features[k] = at(k);
    const ImmersedDisc::Renumbering map = seed_.disc.compact();
    for (PatchVertexId& v : seed_.features) v = map.vertices[v];
    for (auto& sheet : seed_.sheets)
      for (PatchFaceId& q : sheet) q = map.faces[q];
    return std::move(seed_);
  }

  const DecalInput& input_;
  const std::vector<VertexFeature>& features_;
  const ConvexGraph& graph_;
  const GraphPaths& paths_;
  const std::vector<std::vector<FaceId>>& regions_;
  std::uint32_t start_;
  PaperSeed seed_;
  std::vector<std::uint32_t> queue_;  // features placed, in order
};

}  // namespace

Result<PaperSeed> build_paper_seed(BridgedSurface& surface, const DecalInput& input,
                                   const std::vector<VertexFeature>& features, const ConvexGraph& graph,
                                   const GraphPaths& paths, const std::vector<std::vector<FaceId>>& regions) {
  return Builder(surface, input, features, graph, paths, regions).run();
}

}  // namespace applique
