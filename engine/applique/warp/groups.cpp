#include "applique/warp/groups.h"

#include <map>
#include <utility>

#include "applique/base/predicates.h"
#include "applique/warp/warp.h"

namespace applique {
namespace {

/// Calls visit(e, f) for any two edges of the planar graph that share no feature and cross.
template <class Visit>
void for_crossing_edges(std::span<const Vec2> features, const FeatureGraph& graph, Visit visit) {
  for (std::size_t i = 0; i < graph.planar.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto [a, b] = graph.planar[i];
      const auto [c, d] = graph.planar[j];
      if (a == c || a == d || b == c || b == d) continue;
      const auto side = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
        return orientation(features[p], features[q], features[r]);
      };
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0)
        visit(graph.planar[i], graph.planar[j]);
    }
}

/// Runs of one group along the tree, from its leaves: a feature takes those of its branches that are still
/// alone.
class RunCutter {
 public:
  RunCutter(const std::vector<std::uint32_t>& group, const FeatureGraph& graph)
      : neighbours_(group.size()), run_(group.size(), none) {
    for (const auto& [a, b] : graph.tree)
      if (group[a] == group[b]) {
        neighbours_[a].push_back(b);
        neighbours_[b].push_back(a);
      }
  }

  /// The run of each feature of the group that `root` is joined to by the tree; numbers go on from `next`.
  void cut(std::uint32_t root, std::uint32_t& next) {
    if (run_[root] != none) return;
    if (!visit(root, root, next)) return;
    // The root is left alone: it joins a neighbour's run, or has none.
    run_[root] = neighbours_[root].empty() ? next++ : run_[neighbours_[root].front()];
  }

  [[nodiscard]] const std::vector<std::uint32_t>& runs() const { return run_; }

 private:
  static constexpr std::uint32_t none = ~0U;

  /// Whether the feature is still alone when its branches are done.
  bool visit(std::uint32_t at, std::uint32_t parent, std::uint32_t& next) {
    std::vector<std::uint32_t> alone;
    for (const std::uint32_t branch : neighbours_[at])
      if (branch != parent && visit(branch, at, next)) alone.push_back(branch);
    if (alone.empty()) return true;
    for (const std::uint32_t branch : alone) run_[branch] = next;
    run_[at] = next++;
    return false;
  }

  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<std::uint32_t> run_;
};

}  // namespace

FeatureGroups groups_of(const InfluenceField& field, std::vector<std::uint32_t> group) {
  FeatureGroups groups{field.groups(), std::move(group), {}};
  if (groups.count == 1) return {};
  groups.meet.assign(std::size_t{groups.count} * groups.count, false);
  for (std::uint32_t point = 0; point < field.triangulation().points.size(); ++point) {
    const auto influence = field.at_point(point);
    for (std::uint32_t a = 0; a < groups.count; ++a) {
      if (influence_ramp(influence[a], groups.count) <= 0) continue;
      for (std::uint32_t b = 0; b < groups.count; ++b)
        if (influence_ramp(influence[b], groups.count) > 0) groups.meet[a * groups.count + b] = true;
    }
  }
  return groups;
}

bool graph_overlaps(std::span<const Vec2> features, const FeatureGraph& graph) {
  bool overlaps = false;
  for_crossing_edges(features, graph, [&](const FeaturePair&, const FeaturePair&) { overlaps = true; });
  for (const auto& [a, b, c] : graph.triangles)
    overlaps = overlaps || orientation(features[a], features[b], features[c]) < 0;
  return overlaps;
}

std::vector<std::uint32_t> cut_overlapping_groups(std::vector<std::uint32_t> group,
                                                  std::span<const Vec2> features, const FeatureGraph& graph,
                                                  bool all) {
  std::vector<char> cut(group.size(), all);  // by group
  for_crossing_edges(features, graph, [&](const FeaturePair& e, const FeaturePair& f) {
    if (group[e[0]] == group[e[1]] && group[f[0]] == group[f[1]] && group[e[0]] == group[f[0]])
      cut[group[e[0]]] = true;
  });
  RunCutter cutter(group, graph);
  std::uint32_t next = 0;
  for (std::uint32_t k = 0; k < group.size(); ++k)
    if (cut[group[k]]) cutter.cut(k, next);
  std::map<std::pair<bool, std::uint32_t>, std::uint32_t> numbers;
  std::vector<std::uint32_t> result(group.size());
  for (std::uint32_t k = 0; k < group.size(); ++k) {
    const bool is_run = cut[group[k]] != 0;
    const auto number = static_cast<std::uint32_t>(numbers.size());
    result[k] = numbers.try_emplace({is_run, is_run ? cutter.runs()[k] : group[k]}, number).first->second;
  }
  return result;
}

}  // namespace applique
