#include "applique/paper/forward_warp.h"

#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

#include "applique/base/predicates.h"
#include "applique/region/clusters.h"
#include "applique/region/influence.h"
#include "applique/warp/build_warp.h"

namespace applique {
namespace {

constexpr ImageFrame frame{1000, 1000};

/// A region in the shape of a U, three features in each arm and two in the middle, and where they go: the
/// arms bend inward until they cross.
struct CrossedArms {
  CrossedArms() {
    for (const Pixel& p : std::vector<Pixel>{
             {120, 100}, {120, 400}, {120, 700}, {350, 850}, {650, 850}, {880, 700}, {880, 400}, {880, 100}})
      from.push_back(frame.to_plane(p));
    for (const Pixel& p : std::vector<Pixel>{
             {760, 150}, {560, 400}, {280, 660}, {370, 850}, {630, 850}, {720, 660}, {440, 400}, {240, 150}})
      to.push_back(frame.to_plane(p));
    graph = build_feature_graph(region, from);
    group = cluster_features(region, from, graph);
    groups = *std::max_element(group.begin(), group.end()) + 1;
  }

  Region region = *Region::from_contour(
      {{0, 0}, {240, 0}, {240, 720}, {760, 720}, {760, 0}, {1000, 0}, {1000, 1000}, {0, 1000}}, frame);
  std::vector<Vec2> from, to;
  FeatureGraph graph;
  std::uint32_t groups = 1;
  std::vector<std::uint32_t> group;
};

int count_flips(const RegionTriangulation& triangulation, const std::vector<Vec2>& points) {
  int flips = 0;
  for (const auto& t : triangulation.triangles)
    flips += orientation(points[t[0]], points[t[1]], points[t[2]]) <= 0 ? 1 : 0;
  return flips;
}

TEST(ForwardWarp, ReproducesASimilarityAndTheFeatures) {
  CrossedArms arms;
  const Vec2 scale = std::polar(0.7, 1.1), shift(0.2, -0.1);
  ForwardWarp warp{arms.from, {}, arms.graph.visible, 1, {}};
  std::vector<Vec2> expected;
  for (Vec2 z : arms.region.polygon()) expected.push_back(scale * z + shift);
  for (Vec2 z : arms.from) warp.to.push_back(scale * z + shift);
  const std::vector<Vec2> contour = warp_forward(warp, arms.region.polygon());
  for (std::size_t i = 0; i < contour.size(); ++i) EXPECT_LT(std::abs(contour[i] - expected[i]), 1e-12);

  warp.to = arms.to;
  const std::vector<Vec2> features = warp_forward(warp, arms.from, {}, 3);
  for (std::size_t k = 0; k < features.size(); ++k) EXPECT_LT(std::abs(features[k] - arms.to[k]), 1e-12);
}

TEST(ForwardWarp, FindsThePairThatCollides) {
  const ForwardWarp half_turn{
      {Vec2(-1), Vec2(1), Vec2(0, 1)}, {Vec2(1), Vec2(-1), Vec2(0, 1)}, {{0, 2}, {0, 1}}, 1, {}};
  EXPECT_EQ(colliding_pair(half_turn), 1u);
  const ForwardWarp turn{{Vec2(-1), Vec2(1)}, {Vec2(0, -1), Vec2(0, 1)}, {{0, 1}}, 1, {}};
  EXPECT_EQ(colliding_pair(turn), 1u);
}

TEST(ForwardWarp, FoldsByThePapersRuleWhereArmsCrossAndNotByTheProductRule) {
  const CrossedArms arms;
  ForwardWarp paper{arms.from, arms.to, arms.graph.visible, arms.groups, arms.group};
  Warp product = build_warp(arms.from, arms.to, arms.graph, {});
  product.groups = arms.groups;
  product.group = arms.group;
  int before = 0;
  for (const double edge : {0.1, 0.05, 0.025}) {
    const InfluenceField field(arms.region, arms.from, arms.graph, arms.group,
                               {edge / arms.region.diameter()});
    const auto& points = field.triangulation().points;
    std::vector<double> influence;
    std::vector<Vec2> warped;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
      const auto at = field.at_point(p);
      influence.insert(influence.end(), at.begin(), at.end());
      warped.push_back(product(points[p], at));
    }
    const int by_paper = count_flips(field.triangulation(), warp_forward(paper, points, influence));
    const int by_product = count_flips(field.triangulation(), warped);
    std::printf("edges of %.4f: %zu triangles, %d turned over by the paper's rule, %d by the product rule\n",
                edge, field.triangulation().triangles.size(), by_paper, by_product);
    EXPECT_GT(by_paper, before);
    EXPECT_EQ(by_product, 0);
    before = by_paper;
  }
}

}  // namespace
}  // namespace applique
