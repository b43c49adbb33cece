#include "applique/warp/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace applique {
namespace {

constexpr double straight_limit = 0.35;
constexpr std::size_t least_pieces = 8;
constexpr std::size_t most_pieces = 32;

double distance_to_origin(Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double length2 = std::norm(d);
  const double t = length2 > 0 ? std::clamp(-dot(a, d) / length2, 0.0, 1.0) : 0;
  return std::abs(a + t * d);
}

/// log(e(1) / e(0)) per edge; the turns of edges that share a feature are taken on nearby branches.
std::vector<Vec2> edge_rates(std::span<const Vec2> from, std::span<const Vec2> to,
                             std::span<const FeaturePair> edges) {
  std::vector<Vec2> rates(edges.size());
  std::vector<char> known(edges.size(), false);
  const auto principal = [&](std::size_t i) {
    const auto [a, b] = edges[i];
    return std::log((to[b] - to[a]) / (from[b] - from[a]));
  };
  std::vector<std::size_t> queue;
  for (std::size_t root = 0; root < edges.size(); ++root) {
    if (known[root]) continue;
    known[root] = true;
    rates[root] = principal(root);
    queue.push_back(root);
    while (!queue.empty()) {
      const std::size_t i = queue.back();
      queue.pop_back();
      for (std::size_t j = 0; j < edges.size(); ++j) {
        const bool touch = edges[i][0] == edges[j][0] || edges[i][0] == edges[j][1] ||
                           edges[i][1] == edges[j][0] || edges[i][1] == edges[j][1];
        if (known[j] || !touch) continue;
        known[j] = true;
        const Vec2 rate = principal(j);
        const double turns = std::round((rates[i].imag() - rate.imag()) / (2 * std::numbers::pi));
        rates[j] = rate + Vec2(0, 2 * std::numbers::pi * turns);
        queue.push_back(j);
      }
    }
  }
  return rates;
}

std::vector<std::vector<Vec2>> turning_keyframes(std::span<const Vec2> from, std::span<const Vec2> to,
                                                 std::span<const FeaturePair> edges, std::size_t pieces) {
  const auto n = static_cast<Eigen::Index>(from.size());
  const std::vector<Vec2> rates = edge_rates(from, to, edges);
  // Least squares: each edge wants to be its start turned and scaled by a share t; the mean moves straight.
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Constant(n, n, 1.0 / static_cast<double>(n));
  for (const auto& [a, b] : edges) {
    laplacian(a, a) += 1;
    laplacian(b, b) += 1;
    laplacian(a, b) -= 1;
    laplacian(b, a) -= 1;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(laplacian);
  Vec2 start = 0, end = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    start += from[k];
    end += to[k];
  }
  std::vector<std::vector<Vec2>> keyframes = {{from.begin(), from.end()}};
  for (std::size_t piece = 1; piece < pieces; ++piece) {
    const double t = static_cast<double>(piece) / static_cast<double>(pieces);
    const Vec2 mean = ((1 - t) * start + t * end) / static_cast<double>(n);
    Eigen::MatrixX2d right(n, 2);
    right.col(0).setConstant(mean.real());
    right.col(1).setConstant(mean.imag());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto [a, b] = edges[i];
      const Vec2 wanted = (from[b] - from[a]) * std::exp(t * rates[i]);
      right.row(b) += Eigen::RowVector2d(wanted.real(), wanted.imag());
      right.row(a) -= Eigen::RowVector2d(wanted.real(), wanted.imag());
    }
    const Eigen::MatrixX2d solved = solver.solve(right);
    std::vector<Vec2> frame(from.size());
    for (Eigen::Index k = 0; k < n; ++k) frame[k] = Vec2(solved(k, 0), solved(k, 1));
    keyframes.push_back(std::move(frame));
  }
  keyframes.emplace_back(to.begin(), to.end());
  return keyframes;
}

double closest_of(const std::vector<std::vector<Vec2>>& keyframes, std::span<const FeaturePair> pairs) {
  double closest = 1;
  for (const FeaturePair& pair : pairs) closest = std::min(closest, closest_approach(keyframes, pair));
  return closest;
}

}  // namespace

double closest_approach(const std::vector<std::vector<Vec2>>& keyframes, FeaturePair pair) {
  const auto edge = [&](const std::vector<Vec2>& frame) { return frame[pair[1]] - frame[pair[0]]; };
  const double ends = std::min(std::abs(edge(keyframes.front())), std::abs(edge(keyframes.back())));
  double closest = ends;
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k)
    closest = std::min(closest, distance_to_origin(edge(keyframes[k]), edge(keyframes[k + 1])));
  return closest / ends;
}

std::vector<std::vector<Vec2>> feature_trajectories(std::span<const Vec2> from, std::span<const Vec2> to,
                                                    const FeatureGraph& graph,
                                                    std::span<const FeaturePair> pairs) {
  std::vector<std::vector<Vec2>> best = {{from.begin(), from.end()}, {to.begin(), to.end()}};
  double best_approach = closest_of(best, pairs);
  if (best_approach >= straight_limit) return best;
  std::vector<FeaturePair> edges = graph.planar;
  edges.insert(edges.end(), graph.artificial.begin(), graph.artificial.end());
  for (std::size_t pieces = least_pieces; pieces <= most_pieces; pieces *= 2) {
    auto turning = turning_keyframes(from, to, edges, pieces);
    const double approach = closest_of(turning, pairs);
    if (approach <= best_approach) continue;
    best_approach = approach;
    best = std::move(turning);
    if (best_approach >= straight_limit) break;
  }
  return best;
}

}  // namespace applique
