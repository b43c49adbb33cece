#include "applique/region/clusters.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <tuple>

#include "applique/base/predicates.h"
#include "applique/region/triangulation.h"

namespace applique {
namespace {

constexpr std::uint32_t none = ~0U;

/// Whether more than a point of the segment from p to q lies in the closed triangle.
bool runs_through(Vec2 p, Vec2 q, const std::array<Vec2, 3>& corner) {
  if (!boxes_meet(p, q, corner[0], corner[1]) && !boxes_meet(p, q, corner[1], corner[2]) &&
      !boxes_meet(p, q, corner[2], corner[0])) {
    return false;
  }
  std::array<int, 3> side;
  for (int k = 0; k < 3; ++k) side[k] = orientation(p, q, corner[k]);
  const auto [least, most] = std::minmax({side[0], side[1], side[2]});
  for (int k = 0; k < 3; ++k) {
    const Vec2 a = corner[(k + 1) % 3], b = corner[(k + 2) % 3];
    if (side[(k + 1) % 3] == 0 && side[(k + 2) % 3] == 0) {  // Along this edge.
      const Vec2 along = b - a;
      const double from = std::max(0.0, std::min(dot(p - a, along), dot(q - a, along)));
      return from < std::min(dot(along, along), std::max(dot(p - a, along), dot(q - a, along)));
    }
    // Its line runs through the triangle: the segment must not end before it.
    if (orientation(a, b, p) <= 0 && orientation(a, b, q) <= 0) return false;
  }
  return least < 0 && most > 0;
}

/// The rule of the paper, over features that are sorted by place.
class Clusters {
 public:
  Clusters(const Region& region, std::vector<Vec2> features, std::vector<FeaturePair> visible,
           std::vector<FeaturePair> artificial)
      : region_(region),
        features_(std::move(features)),
        visible_(std::move(visible)),
        artificial_(std::move(artificial)),
        group_(features_.size(), none) {}

  std::vector<std::uint32_t> run() {
    group_by_triangles();
    for (std::uint32_t& group : group_) {
      if (group == none) group = groups_++;
    }
    // Those that see others first: where they go does not depend on the rest.
    std::vector<char> blind(features_.size(), 1);
    for (const auto& [i, j] : visible_) blind[i] = blind[j] = 0;
    for (std::uint32_t i = 0; i < features_.size(); ++i) {
      if (!blind[i]) join_partner(i, visible_);
    }
    for (std::uint32_t i = 0; i < features_.size(); ++i) {
      if (blind[i]) join_partner(i, artificial_);
    }
    while (merge_two()) {
    }
    return group_;
  }

 private:
  void group_by_triangles() {
    const RegionTriangulation mesh = triangulate_region(region_, features_, {});
    std::vector<std::vector<std::uint32_t>> through(mesh.triangles.size());  // Segments, by triangle.
    std::vector<double> areas;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& c = mesh.triangles[t];
      const std::array<Vec2, 3> corner = {mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]};
      areas.push_back(cross(corner[1] - corner[0], corner[2] - corner[0]));
      for (std::uint32_t s = 0; s < visible_.size(); ++s) {
        if (runs_through(features_[visible_[s][0]], features_[visible_[s][1]], corner)) {
          through[t].push_back(s);
        }
      }
    }
    for (;;) {
      std::size_t best = 0;
      for (std::size_t t = 0; t < through.size(); ++t) {
        std::erase_if(through[t], [&](std::uint32_t s) {
          return group_[visible_[s][0]] != none && group_[visible_[s][1]] != none;
        });
        if (std::pair(through[t].size(), areas[t]) > std::pair(through[best].size(), areas[best])) best = t;
      }
      if (through[best].empty()) return;
      for (const std::uint32_t s : through[best]) {
        for (const std::uint32_t i : visible_[s]) {
          if (group_[i] == none) group_[i] = groups_;
        }
      }
      ++groups_;
    }
  }

  /// To the group of the nearest partner, unless one is in feature i's own.
  void join_partner(std::uint32_t i, const std::vector<FeaturePair>& pairs) {
    std::optional<std::uint32_t> nearest;
    const auto distance = [&](std::uint32_t j) { return std::norm(features_[j] - features_[i]); };
    for (const auto& [a, b] : pairs) {
      if (a != i && b != i) continue;
      const std::uint32_t j = a + b - i;
      if (group_[j] == group_[i]) return;
      if (!nearest || distance(j) < distance(*nearest)) nearest = j;
    }
    if (nearest) group_[i] = group_[*nearest];
  }

  bool merge_two() {
    for (std::uint32_t kept = 0; kept < groups_; ++kept) {
      for (std::uint32_t other = kept + 1; other < groups_; ++other) {
        if (!see_each_other(kept, other)) continue;
        std::replace(group_.begin(), group_.end(), other, kept);
        return true;
      }
    }
    return false;
  }

  /// Neither is empty, and all features of the two see each other.
  [[nodiscard]] bool see_each_other(std::uint32_t first, std::uint32_t second) const {
    std::vector<std::uint32_t> members;
    for (std::uint32_t i = 0; i < group_.size(); ++i) {
      if (group_[i] == first || group_[i] == second) members.push_back(i);
    }
    const auto in_first = [&](std::uint32_t i) { return group_[i] == first; };
    if (std::all_of(members.begin(), members.end(), in_first) ||
        std::none_of(members.begin(), members.end(), in_first)) {
      return false;
    }
    for (const std::uint32_t i : members) {
      for (const std::uint32_t j : members) {
        if (i < j && !region_.contains_segment(features_[i], features_[j])) return false;
      }
    }
    return true;
  }

  const Region& region_;
  std::vector<Vec2> features_;
  std::vector<FeaturePair> visible_, artificial_;
  std::vector<std::uint32_t> group_;
  std::uint32_t groups_ = 0;
};

}  // namespace

std::vector<std::uint32_t> cluster_features(const Region& region, std::span<const Vec2> features,
                                            const FeatureGraph& graph) {
  // Sorted by place, so that nothing depends on the features' order.
  std::vector<std::uint32_t> order(features.size()), rank(features.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return std::pair(features[i].real(), features[i].imag()) <
           std::pair(features[j].real(), features[j].imag());
  });
  std::vector<Vec2> sorted;
  for (const std::uint32_t i : order) {
    rank[i] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(features[i]);
  }
  const auto ranked = [&](std::vector<FeaturePair> pairs) {
    for (auto& [i, j] : pairs) std::tie(i, j) = std::minmax({rank[i], rank[j]});
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  };
  const std::vector<std::uint32_t> found =
      Clusters(region, std::move(sorted), ranked(graph.visible), ranked(graph.artificial)).run();

  std::vector<std::uint32_t> number(features.size(), none), group(features.size());
  std::uint32_t groups = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    std::uint32_t& named = number[found[rank[i]]];
    if (named == none) named = groups++;
    group[i] = named;
  }
  return group;
}

}  // namespace applique
