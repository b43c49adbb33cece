#include "applique/paper/forward_warp.h"

#include <algorithm>

#include "applique/base/parallel.h"

namespace applique {
namespace {

constexpr double collision = 1e-6;  // of the longer of a pair's first and last distances

/// What a step needs of the features and pairs at its start.
struct StepTable {
  std::vector<Vec2> position;        // by feature
  std::vector<Vec2> lambda, offset;  // by pair: the velocity lambda p + offset
};

StepTable tabulate(const ForwardWarp& warp, double t) {
  StepTable table;
  for (std::size_t k = 0; k < warp.from.size(); ++k)
    table.position.push_back(warp.from[k] + t * (warp.to[k] - warp.from[k]));
  for (const auto& [i, j] : warp.pairs) {
    const Vec2 velocity_i = warp.to[i] - warp.from[i], velocity_j = warp.to[j] - warp.from[j];
    const Vec2 lambda = (velocity_j - velocity_i) / (table.position[j] - table.position[i]);
    table.lambda.push_back(lambda);
    table.offset.push_back(velocity_i - lambda * table.position[i]);
  }
  return table;
}

/// alpha_{p,i,j}: by pair.
std::vector<double> pair_influence(const ForwardWarp& warp, std::span<const double> influence) {
  std::vector<double> alpha(warp.pairs.size(), 1);
  if (warp.groups == 1) return alpha;
  for (std::size_t q = 0; q < warp.pairs.size(); ++q) {
    const std::uint32_t a = warp.group[warp.pairs[q][0]], b = warp.group[warp.pairs[q][1]];
    alpha[q] = influence[a] + (a == b ? 0 : influence[b]);
  }
  return alpha;
}

/// Eq. (3). All weights are multiplied by the squared distance of the nearest feature m, so that at a feature
/// its own pairs are left.
Vec2 velocity_at(const ForwardWarp& warp, const StepTable& table, const std::vector<double>& alpha, Vec2 p,
                 std::vector<double>& squared) {
  for (std::size_t k = 0; k < squared.size(); ++k) squared[k] = std::norm(p - table.position[k]);
  const auto m =
      static_cast<std::uint32_t>(std::min_element(squared.begin(), squared.end()) - squared.begin());
  double total = 0;
  Vec2 lambda = 0, offset = 0;
  for (std::size_t q = 0; q < warp.pairs.size(); ++q) {
    const auto [i, j] = warp.pairs[q];
    const double beta = i == m   ? 1 / squared[j]
                        : j == m ? 1 / squared[i]
                                 : squared[m] / (squared[i] * squared[j]);
    const double weight = beta * alpha[q];
    total += weight;
    lambda += weight * table.lambda[q];
    offset += weight * table.offset[q];
  }
  return (lambda * p + offset) / total;
}

}  // namespace

std::vector<Vec2> warp_forward(const ForwardWarp& warp, std::span<const Vec2> points,
                               std::span<const double> influence, int steps) {
  std::vector<StepTable> tables;
  for (int step = 0; step < steps; ++step) tables.push_back(tabulate(warp, double(step) / steps));
  std::vector<Vec2> warped(points.begin(), points.end());
  parallel_ranges(points.size(), 256, [&](std::size_t first, std::size_t last) {
    std::vector<double> squared(warp.from.size());
    for (std::size_t v = first; v < last; ++v) {
      const std::vector<double> alpha = pair_influence(
          warp, warp.groups == 1 ? influence : influence.subspan(v * warp.groups, warp.groups));
      for (const StepTable& table : tables)
        warped[v] += velocity_at(warp, table, alpha, warped[v], squared) / static_cast<double>(steps);
    }
  });
  return warped;
}

std::size_t colliding_pair(const ForwardWarp& warp) {
  const auto collides = [&](const FeaturePair& pair) {
    const Vec2 start = warp.from[pair[1]] - warp.from[pair[0]], end = warp.to[pair[1]] - warp.to[pair[0]];
    const Vec2 way = end - start;
    const double t = std::norm(way) > 0 ? std::clamp(-dot(start, way) / std::norm(way), 0.0, 1.0) : 0;
    return std::abs(start + t * way) <= collision * std::max(std::abs(start), std::abs(end));
  };
  return static_cast<std::size_t>(std::find_if(warp.pairs.begin(), warp.pairs.end(), collides) -
                                  warp.pairs.begin());
}

}  // namespace applique
