#include "applique/warp/stress.h"

#include <cmath>
#include <numbers>

namespace applique {
namespace {

constexpr double extreme_scale = 4;
constexpr double extreme_turn = 2 * std::numbers::pi / 3;

/// The velocity's complex derivative at each feature (§3.1 of the design: next to a feature only its own
/// pairs count, and of them, where there are groups, those with its group).
std::vector<Vec2> derivatives_at_features(const Warp& warp, std::size_t stage) {
  const Vec2* position = &warp.position[stage * warp.features];
  std::vector<Vec2> sum(warp.features);
  std::vector<double> total(warp.features);
  for (std::size_t q = 0; q < warp.pairs.size(); ++q) {
    const auto [i, j] = warp.pairs[q];
    if (warp.groups > 1 && warp.group[i] != warp.group[j]) continue;
    const double weight = 1 / std::norm(position[i] - position[j]);
    for (const std::uint32_t k : {i, j}) {
      sum[k] += weight * warp.lambda[stage * warp.pairs.size() + q];
      total[k] += weight;
    }
  }
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= total[k];
  return sum;
}

/// The logarithm of the warp's derivative at each feature: Simpson's rule over the stages of the steps.
std::vector<Vec2> log_derivatives(const Warp& warp, std::size_t features) {
  std::vector<Vec2> integral(features);
  for (std::size_t step = 0; step < warp.steps; ++step)
    for (std::size_t half = 0; half < 3; ++half) {
      const std::vector<Vec2> rate = derivatives_at_features(warp, 3 * step + half);
      const double weight = (half == 1 ? 4.0 : 1.0) / (6.0 * warp.steps);
      for (std::size_t k = 0; k < features; ++k) integral[k] += weight * rate[k];
    }
  return integral;
}

}  // namespace

WarpStress measure_stress(std::span<const Vec2> from, std::span<const Vec2> to,
                          std::span<const FeaturePair> pairs, const Warp& warp) {
  WarpStress stress;
  const std::vector<Vec2> logs = log_derivatives(warp, from.size());
  for (std::size_t k = 0; k < from.size(); ++k)
    stress.features.push_back({std::abs(to[k] - from[k]), std::exp(logs[k].real()), logs[k].imag()});
  for (const auto& [i, j] : pairs) {
    const Vec2 ratio = (to[j] - to[i]) / (from[j] - from[i]);
    stress.pairs.push_back({{i, j}, std::abs(ratio), std::arg(ratio)});
  }
  return stress;
}

bool is_extreme(double scale, double turn) {
  return scale > extreme_scale || scale < 1 / extreme_scale || std::abs(turn) > extreme_turn;
}

}  // namespace applique
