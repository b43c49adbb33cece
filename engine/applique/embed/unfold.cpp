#include "applique/embed/unfold.h"

#include <algorithm>
#include <cmath>

#include "applique/base/predicates.h"
#include "applique/embed/mean_value.h"

namespace applique {
namespace {

constexpr int most_rounds = 10;
constexpr double widening = 1.35;      // of the neighbourhood's radius, per round
constexpr double margin_edges = 2;     // mean edges between a fold and its neighbourhood's rim
constexpr double largest_share = 0.5;  // of the vertices: a fold that needs more is not local

/// Vertex adjacency in compressed rows.
struct Adjacency {
  std::vector<std::size_t> first;
  std::vector<int> neighbours;

  explicit Adjacency(const DiscGeometry& disc) : first(disc.vertices + 1, 0) {
    for (const auto& f : disc.faces)
      for (int v : f) first[v + 1] += 2;
    for (std::size_t v = 0; v < disc.vertices; ++v) first[v + 1] += first[v];
    neighbours.resize(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (const auto& f : disc.faces)
      for (int k = 0; k < 3; ++k) {
        neighbours[next[f[k]]++] = f[(k + 1) % 3];
        neighbours[next[f[k]]++] = f[(k + 2) % 3];
      }
  }

  /// Spreads from `seeds` through vertices that `accept`; returns those reached.
  template <class Accept>
  std::vector<int> spread(const std::vector<int>& seeds, Accept accept) const {
    std::vector<int> reached;
    std::vector<char> seen(first.size() - 1, false);
    for (int v : seeds)
      if (!seen[v] && accept(v)) {
        seen[v] = true;
        reached.push_back(v);
      }
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (std::size_t n = first[reached[i]]; n < first[reached[i] + 1]; ++n) {
        const int w = neighbours[n];
        if (seen[w] || !accept(w)) continue;
        seen[w] = true;
        reached.push_back(w);
      }
    return reached;
  }
};

std::vector<char> turned_over(const DiscGeometry& disc, const std::vector<Vec2>& plane) {
  std::vector<char> vertices(disc.vertices, false);
  for (const auto& f : disc.faces)
    if (orientation(plane[f[0]], plane[f[1]], plane[f[2]]) <= 0)
      for (int v : f) vertices[v] = true;
  return vertices;
}

double mean_edge(const DiscGeometry& disc) {
  double sum = 0;
  for (const auto& l : disc.lengths) sum += l[0] + l[1] + l[2];
  return sum / static_cast<double>(3 * disc.lengths.size());
}

}  // namespace

std::size_t unfold_locally(const DiscGeometry& disc, std::vector<Vec2>& plane) {
  const Adjacency adjacency(disc);
  const double edge = mean_edge(disc);
  std::vector<char> rim(disc.vertices, false);
  for (int v : disc.boundary) rim[v] = true;
  std::size_t flips = count_flips(disc, plane);
  double factor = 1;
  for (int round = 0; round < most_rounds && flips > 0; ++round, factor *= widening) {
    const std::vector<char> folded = turned_over(disc, plane);
    std::vector<char> free(disc.vertices, false), clustered(disc.vertices, false);
    std::size_t free_count = 0;
    for (std::size_t v = 0; v < disc.vertices; ++v) {
      if (!folded[v] || clustered[v]) continue;
      const std::vector<int> cluster =
          adjacency.spread({static_cast<int>(v)}, [&](int w) { return folded[w] != 0; });
      Vec2 centre = 0;
      for (int w : cluster) {
        clustered[w] = true;
        centre += plane[w] / static_cast<double>(cluster.size());
      }
      double radius = 0;
      for (int w : cluster) radius = std::max(radius, std::abs(plane[w] - centre));
      radius = factor * (radius + margin_edges * edge);
      const auto near = [&](int w) { return !rim[w] && std::abs(plane[w] - centre) < radius; };
      for (int w : adjacency.spread(cluster, near)) {
        free_count += !free[w];
        free[w] = true;
      }
    }
    if (static_cast<double>(free_count) > largest_share * static_cast<double>(disc.vertices)) break;
    place_by_mean_value(disc, free, plane);
    flips = count_flips(disc, plane);
  }
  return flips;
}

}  // namespace applique
