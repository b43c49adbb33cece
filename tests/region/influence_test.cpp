#include "applique/region/influence.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "applique/region/clusters.h"

#include "region/contours.h"

namespace applique {
namespace {

// Wide arms: the influence has room to change across them, too.
const std::vector<Pixel> wide_horseshoe = {{8, 8},   {80, 8},  {80, 176},  {176, 176},
                                           {176, 8}, {248, 8}, {248, 248}, {8, 248}};
const std::vector<Vec2> arms = {plane(40, 30), plane(50, 150), plane(210, 20), plane(200, 160)};

std::vector<double> influence_at(const InfluenceField& field, Vec2 z) {
  std::vector<double> influence(field.groups());
  field.at(z, influence);
  return influence;
}

TEST(Influence, EachArmOfAHorseshoeFollowsItsOwnFeatures) {
  const Region region = make_region(wide_horseshoe);
  const FeatureGraph graph = build_feature_graph(region, arms);
  const std::vector<std::uint32_t> group = cluster_features(region, arms, graph);
  ASSERT_EQ(group, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  const InfluenceField field(region, arms, graph, group);
  EXPECT_EQ(field.groups(), 2U);
  // Above 0.95 the ramp of a warp of two groups makes it all.
  for (const Vec2 z : {plane(10, 10), plane(78, 12), plane(75, 60), plane(20, 100)}) {
    EXPECT_GT(influence_at(field, z)[0], 0.95) << z;
    const Vec2 mirrored = {-z.real(), z.imag()};
    EXPECT_GT(influence_at(field, mirrored)[1], 0.95) << mirrored;
  }
  EXPECT_GT(influence_at(field, plane(120, 40))[0], 0.95) << "outside: as at the nearest place";
  EXPECT_GT(influence_at(field, plane(136, 40))[1], 0.95) << "outside: as at the nearest place";
  // At the base, half way, by symmetry up to the features' places.
  EXPECT_NEAR(influence_at(field, plane(128, 212))[0], 0.5, 0.1);

  const std::vector<std::uint32_t> labels = field.segment_labels();
  for (std::size_t t = 0; t < labels.size(); ++t) {
    Vec2 middle = 0;
    for (const std::uint32_t point : field.triangulation().triangles[t]) {
      middle += field.triangulation().points[point] / 3.0;
    }
    if (std::abs(middle.real()) > 0.2) {
      EXPECT_EQ(labels[t], middle.real() < 0 ? 0U : 1U) << middle;
    }
  }
}

// Erratum E8 of the design: with values at points alone they would go on changing with the triangulation.
TEST(Influence, DoesNotDependOnTheTriangulation) {
  const Region region = make_region(wide_horseshoe);
  const FeatureGraph graph = build_feature_graph(region, arms);
  const std::vector<std::uint32_t> group = {0, 0, 1, 1};
  const InfluenceField finest(region, arms, graph, group, {1.0 / 160});
  for (const double max_edge : {1.0 / 20, 1.0 / 40, 1.0 / 80}) {
    const InfluenceField field(region, arms, graph, group, {max_edge});
    for (const Vec2 z :
         {plane(20, 60), plane(75, 160), plane(60, 200), plane(100, 220), plane(128, 212), plane(180, 240)}) {
      EXPECT_NEAR(influence_at(field, z)[0], influence_at(finest, z)[0], 1e-2) << z << " " << max_edge;
    }
  }
}

// Two segments across a strip: between them the influence is linear.
TEST(Influence, IsLinearBetweenTwoParallelSegments) {
  const Region region = make_region({{0, 100}, {256, 100}, {256, 150}, {0, 150}});
  const std::vector<Vec2> features = {plane(28, 100), plane(28, 150), plane(228, 100), plane(228, 150)};
  FeatureGraph graph;
  graph.planar = {{0, 1}, {2, 3}};
  const std::vector<std::uint32_t> group = {0, 0, 1, 1};
  const InfluenceField field(region, features, graph, group);
  for (const double x : {0.0, 20.0, 28.0, 60.0, 100.0, 128.0, 200.0, 230.0, 256.0}) {
    for (const double y : {100.0, 117.0, 150.0}) {
      EXPECT_NEAR(influence_at(field, plane(x, y))[1], std::clamp((x - 28) / 200, 0.0, 1.0), 1e-9) << x;
    }
  }
}

RC_GTEST_PROP(Influence, SumsToOneWithinBounds, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 60), *rc::gen::arbitrary<unsigned>());
  const auto n = *rc::gen::element<std::size_t>(1, 2, 5, 12);
  std::vector<Vec2> features = points_in(region, n, *rc::gen::arbitrary<unsigned>());
  features.push_back(region.polygon()[1]);
  const FeatureGraph graph = build_feature_graph(region, features);
  std::vector<std::uint32_t> group = cluster_features(region, features, graph);
  if (*rc::gen::arbitrary<bool>()) std::iota(group.begin(), group.end(), 0U);  // Each its own.
  const InfluenceField field(region, features, graph, group, {*rc::gen::element(0.1, 0.025)});
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  std::uniform_real_distribution<double> x(-1.5, 1.5);
  std::vector<Vec2> places = features;
  for (int i = 0; i < 50; ++i) places.emplace_back(x(random), x(random));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::vector<double> influence = influence_at(field, places[i]);
    for (const double value : influence) RC_ASSERT(value >= 0 && value <= 1 + 1e-12);
    RC_ASSERT(std::abs(std::accumulate(influence.begin(), influence.end(), 0.0) - 1) < 1e-12);
    if (i < features.size()) RC_ASSERT(std::abs(influence[group[i]] - 1) < 1e-9);
  }
  for (const auto& [i, j] : graph.planar) {
    if (group[i] != group[j]) continue;
    for (const double t : {0.25, 0.5, 0.9}) {
      const Vec2 z = features[i] + t * (features[j] - features[i]);
      RC_ASSERT(std::abs(influence_at(field, z)[group[i]] - 1) < 1e-9);
    }
  }
}

}  // namespace
}  // namespace applique
