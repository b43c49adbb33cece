#include "applique/warp/build_warp.h"

#include <algorithm>
#include <cmath>

#include "applique/warp/trajectory.h"

namespace applique {
namespace {

constexpr std::uint32_t least_steps = 4;
constexpr double still = 1e-13;     // plane units: a feature that moves less does not move
constexpr double collision = 0.05;  // share of its length below which a pair is left out

/// Leaves out pairs that nearly collide on the way, as long as both features keep another in their group.
void drop_colliding(std::vector<FeaturePair>& pairs, const std::vector<std::vector<Vec2>>& keyframes,
                    const FeatureGroups& groups) {
  std::vector<int> count(keyframes[0].size(), 0);
  for (const auto& [i, j] : pairs)
    if (groups.joins({i, j})) {
      ++count[i];
      ++count[j];
    }
  std::erase_if(pairs, [&](const FeaturePair& pair) {
    if (closest_approach(keyframes, pair) >= collision) return false;
    if (!groups.joins(pair)) return true;
    if (count[pair[0]] < 2 || count[pair[1]] < 2) return false;
    --count[pair[0]];
    --count[pair[1]];
    return true;
  });
}

Warp tabulate(const std::vector<std::vector<Vec2>>& keyframes, const std::vector<FeaturePair>& pairs,
              std::uint32_t steps, const FeatureGroups& groups) {
  Warp warp;
  warp.groups = groups.count;
  warp.group = groups.of;
  warp.steps = steps;
  warp.features = static_cast<std::uint32_t>(keyframes[0].size());
  warp.pairs = pairs;
  const auto pieces = static_cast<std::uint32_t>(keyframes.size() - 1);
  const std::uint32_t steps_per_piece = steps / pieces;
  for (std::uint32_t step = 0; step < steps; ++step) {
    const std::vector<Vec2>& start = keyframes[step / steps_per_piece];
    const std::vector<Vec2>& end = keyframes[step / steps_per_piece + 1];
    for (std::uint32_t half = 0; half < 3; ++half) {
      // Share of the way from one keyframe to the next; its ends are taken literally, so that features are
      // exact.
      const double t = (2.0 * (step % steps_per_piece) + half) / (2.0 * steps_per_piece);
      const std::size_t first = warp.position.size();
      for (std::size_t k = 0; k < start.size(); ++k)
        warp.position.push_back(t == 1 ? end[k] : start[k] + t * (end[k] - start[k]));
      for (const auto& [i, j] : pairs) {
        const Vec2 move_i = static_cast<double>(pieces) * (end[i] - start[i]);
        const Vec2 move_j = static_cast<double>(pieces) * (end[j] - start[j]);
        const Vec2 rate = (move_j - move_i) / (warp.position[first + j] - warp.position[first + i]);
        warp.lambda.push_back(rate);
        warp.offset.push_back(move_i - rate * warp.position[first + i]);
      }
    }
  }
  return warp;
}

}  // namespace

std::vector<FeaturePair> warp_pairs(const FeatureGraph& graph, std::size_t features,
                                    const FeatureGroups& groups) {
  std::vector<FeaturePair> pairs = graph.visible;
  std::erase_if(pairs, [&](const FeaturePair& pair) { return groups.apart(pair); });
  std::vector<char> paired(features, false);
  for (const auto& [i, j] : pairs) paired[i] = paired[j] = true;
  for (const FeaturePair& pair : graph.artificial)
    if (!paired[pair[0]] || !paired[pair[1]]) pairs.push_back(pair);
  return pairs;
}

Warp build_warp(std::span<const Vec2> from, std::span<const Vec2> to, const FeatureGraph& graph,
                std::span<const WarpProbe> probes, const FeatureGroups& groups, const WarpOptions& options) {
  bool moves = false;
  for (std::size_t k = 0; k < from.size(); ++k) moves = moves || std::abs(to[k] - from[k]) > still;
  if (from.size() < 3 || !moves) return {};

  std::vector<FeaturePair> pairs = warp_pairs(graph, from.size(), groups);
  const auto keyframes = feature_trajectories(from, to, graph, pairs);
  drop_colliding(pairs, keyframes, groups);

  const auto pieces = static_cast<std::uint32_t>(keyframes.size() - 1);
  std::uint32_t steps = std::max(least_steps, pieces);
  Warp warp = tabulate(keyframes, pairs, steps, groups);
  while (2 * steps <= options.max_steps) {
    Warp finer = tabulate(keyframes, pairs, 2 * steps, groups);
    double difference = 0;
    for (const auto& [plane, influence] : probes)
      difference = std::max(difference, std::abs(finer(plane, influence) - warp(plane, influence)));
    if (difference <= options.tolerance) break;
    steps *= 2;
    warp = std::move(finer);
  }
  return warp;
}

}  // namespace applique
