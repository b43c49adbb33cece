#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "applique/warp/build_warp.h"
#include "applique/warp/stress.h"
#include "applique/warp/trajectory.h"

namespace applique {
namespace {

/// Every pair sees each other; the planar graph is a chain.
FeatureGraph open_graph(std::uint32_t n) {
  FeatureGraph graph;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j) graph.visible.push_back({i, j});
  for (std::uint32_t i = 0; i + 1 < n; ++i) graph.planar.push_back({i, i + 1});
  graph.tree = graph.planar;
  return graph;
}

std::vector<Vec2> random_points(std::mt19937& random, int n, double size) {
  std::uniform_real_distribution<double> coordinate(-size, size);
  std::vector<Vec2> points;
  while (static_cast<int>(points.size()) < n) {
    const Vec2 z(coordinate(random), coordinate(random));
    bool apart = true;
    for (Vec2 other : points) apart = apart && std::abs(other - z) > 0.2 * size;
    if (apart) points.push_back(z);
  }
  return points;
}

TEST(Warp, IsExactAtTheFeatures) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.08, 0.08);
  for (int run = 0; run < 50; ++run) {
    const int n = 3 + run % 8;
    const std::vector<Vec2> from = random_points(random, n, 0.9);
    std::vector<Vec2> to = from;
    for (Vec2& z : to) z += Vec2(shift(random), shift(random));
    const Warp built = build_warp(from, to, open_graph(static_cast<std::uint32_t>(n)), {});
    for (int k = 0; k < n; ++k) EXPECT_LT(std::abs(built(from[k]) - to[k]), 1e-13);
  }
}

TEST(Warp, ReproducesAnySimilarityEverywhere) {
  std::mt19937 random(6);
  for (int run = 0; run < 20; ++run) {
    const std::vector<Vec2> from = random_points(random, 6, 0.8);
    const Vec2 scale = std::polar(0.6 + 0.05 * run, 0.1 * run - 1), shift(0.3, -0.2);
    std::vector<Vec2> to;
    for (Vec2 z : from) to.push_back(scale * z + shift);
    const Warp built = build_warp(from, to, open_graph(6), {});
    for (Vec2 z : random_points(random, 10, 1)) EXPECT_LT(std::abs(built(z) - (scale * z + shift)), 1e-12);
  }
}

/// A common translation must translate every point exactly: weights that are normalised separately fail here.
TEST(Warp, TranslatesEveryPointUnderACommonTranslation) {
  std::mt19937 random(8);
  const std::vector<Vec2> from = random_points(random, 7, 0.9);
  std::vector<Vec2> to = from;
  for (Vec2& z : to) z += Vec2(0.25, -0.5);
  const Warp built = build_warp(from, to, open_graph(7), {});
  for (Vec2 z : random_points(random, 12, 1)) EXPECT_LT(std::abs(built(z) - z - Vec2(0.25, -0.5)), 1e-13);
}

std::vector<WarpProbe> probes_at(const std::vector<Vec2>& places) {
  std::vector<WarpProbe> probes;
  for (Vec2 z : places) probes.push_back({z, {}});
  return probes;
}

TEST(Warp, SwappingTheEndsInvertsIt) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> shift(-0.1, 0.1);
  const std::vector<Vec2> from = random_points(random, 6, 0.9);
  std::vector<Vec2> to = from;
  for (Vec2& z : to) z += Vec2(shift(random), shift(random));
  const std::vector<Vec2> probes = random_points(random, 15, 1);
  const WarpOptions fine{1e-12, 256};
  const Warp there = build_warp(from, to, open_graph(6), probes_at(probes), {}, fine);
  const Warp back = build_warp(to, from, open_graph(6), probes_at(probes), {}, fine);
  for (Vec2 z : probes) EXPECT_LT(std::abs(back(there(z)) - z), 1e-8);
}

TEST(Warp, StepsAreRefinedUntilTheProbesRest) {
  std::mt19937 random(10);
  const std::vector<Vec2> from = random_points(random, 6, 0.9), to = random_points(random, 6, 0.9);
  const std::vector<Vec2> probes = random_points(random, 15, 1);
  const Warp coarse = build_warp(from, to, open_graph(6), probes_at(probes), {}, {2e-5, 1024});
  const Warp fine = build_warp(from, to, open_graph(6), probes_at(probes), {}, {1e-9, 8192});
  for (Vec2 z : probes) EXPECT_LT(std::abs(coarse(z) - fine(z)), 4e-5);
}

TEST(Warp, RunsBackwardsToo) {
  std::mt19937 random(8);
  const std::vector<Vec2> from = random_points(random, 6, 0.8);
  std::vector<Vec2> to = from;
  std::uniform_real_distribution<double> shift(-0.1, 0.1);
  for (Vec2& z : to) z += Vec2(shift(random), shift(random));
  const std::vector<Vec2> places = random_points(random, 12, 1);
  const Warp warp = build_warp(from, to, open_graph(6), probes_at(places));
  for (const Vec2 z : places) EXPECT_LT(std::abs(warp.backward(warp(z)) - z), 1e-4);
  for (std::size_t k = 0; k < to.size(); ++k) EXPECT_LT(std::abs(warp.backward(to[k]) - from[k]), 1e-13);
}

TEST(Warp, OneAndTwoFeaturesNeedNone) {
  EXPECT_EQ(build_warp(std::vector<Vec2>{{0, 0}}, std::vector<Vec2>{{1, 1}}, open_graph(1), {}).steps, 0u);
  const std::vector<Vec2> ends = {{0, 0}, {1, 1}};
  EXPECT_EQ(build_warp(ends, ends, open_graph(2), {}).steps, 0u);
}

TEST(Warp, TakesCollinearFeatures) {
  const std::vector<Vec2> from = {{-0.8, 0}, {-0.1, 0}, {0.3, 0}, {0.9, 0}};
  const std::vector<Vec2> to = {{-0.7, 0.1}, {-0.2, -0.1}, {0.4, 0.05}, {0.8, 0}};
  const Warp built = build_warp(from, to, open_graph(4), {});
  for (std::size_t k = 0; k < from.size(); ++k) EXPECT_LT(std::abs(built(from[k]) - to[k]), 1e-14);
  EXPECT_LT(std::abs(built({0.1, 0.9}) - Vec2(0.1, 0.9)), 0.5);
}

/// What is told of a feature is the warp's derivative there, by central differences.
TEST(Stress, IsTheWarpsDerivativeAtAFeature) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  for (int run = 0; run < 20; ++run) {
    const int n = 3 + run % 6;
    const std::vector<Vec2> from = random_points(random, n, 0.9);
    std::vector<Vec2> to = from;
    for (Vec2& z : to) z += Vec2(shift(random), shift(random));
    const FeatureGraph graph = open_graph(static_cast<std::uint32_t>(n));
    std::vector<Vec2> near = from;
    for (Vec2& z : near) z += 0.05;
    const Warp warp = build_warp(from, to, graph, probes_at(near), {}, {1e-9, 1024});
    const WarpStress stress = measure_stress(from, to, graph.visible, warp);
    for (int k = 0; k < n; ++k) {
      constexpr double step = 1e-5;
      const Vec2 derivative = (warp(from[k] + step) - warp(from[k] - step)) / (2 * step);
      const Vec2 told = std::polar(stress.features[k].scale, stress.features[k].turn);
      EXPECT_LT(std::abs(derivative - told), 1e-4 * std::abs(told)) << run << ", " << k;
      EXPECT_DOUBLE_EQ(stress.features[k].shift, std::abs(to[k] - from[k]));
    }
  }
}

/// A common similarity asks the same of every feature and of every pair.
TEST(Stress, OfASimilarityIsTheSimilarity) {
  std::mt19937 random(3);
  const std::vector<Vec2> from = random_points(random, 6, 0.9);
  const Vec2 scale = std::polar(1.4, 0.9);
  std::vector<Vec2> to;
  for (const Vec2 z : from) to.push_back(scale * z + Vec2(0.1, -0.2));
  const FeatureGraph graph = open_graph(6);
  const WarpStress stress =
      measure_stress(from, to, graph.visible, build_warp(from, to, graph, {}, {}, {1e-9, 256}));
  for (const FeatureStress& feature : stress.features) {
    EXPECT_NEAR(feature.scale, 1.4, 2e-4);  // Simpson's error in four steps.
    EXPECT_NEAR(feature.turn, 0.9, 2e-4);
  }
  ASSERT_EQ(stress.pairs.size(), 15u);
  for (const PairStress& pair : stress.pairs) {
    EXPECT_NEAR(pair.scale, 1.4, 1e-12);
    EXPECT_NEAR(pair.turn, 0.9, 1e-12);
  }
  for (const FeatureStress& feature : measure_stress(from, from, graph.visible, {}).features) {
    EXPECT_EQ(feature.scale, 1);
    EXPECT_EQ(feature.turn, 0);
    EXPECT_EQ(feature.shift, 0);
  }
}

/// Two features that swap places run straight into one another; turning keyframes keep them apart.
TEST(Trajectory, TurnsWhereStraightLinesWouldCollide) {
  std::vector<Vec2> from = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-0.2, 0}, {0.2, 0}};
  std::vector<Vec2> to = from;
  std::swap(to[4], to[5]);
  const FeatureGraph graph = [] {
    FeatureGraph g = open_graph(6);
    g.planar = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {4, 5}};
    g.artificial = {{0, 4}};
    return g;
  }();
  const auto keyframes = feature_trajectories(from, to, graph, std::vector<FeaturePair>{{4, 5}});
  EXPECT_GE(keyframes.size(), 9u);
  EXPECT_GT(closest_approach(keyframes, {4, 5}), 0.35);
  EXPECT_EQ(keyframes.front()[4], from[4]);
  EXPECT_EQ(keyframes.back()[5], to[5]);
  const Warp built = build_warp(from, to, graph, {});
  for (std::size_t k = 0; k < from.size(); ++k) EXPECT_LT(std::abs(built(from[k]) - to[k]), 1e-12);
  const WarpStress stress = measure_stress(from, to, warp_pairs(graph, 6), built);
  EXPECT_TRUE(std::any_of(stress.pairs.begin(), stress.pairs.end(),
                          [](const PairStress& pair) { return is_extreme(pair.scale, pair.turn); }));
}

}  // namespace
}  // namespace applique
