#include "applique/region/clusters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "region/contours.h"

namespace applique {
namespace {

std::vector<std::uint32_t> cluster(const Region& region, const std::vector<Vec2>& features) {
  return cluster_features(region, features, build_feature_graph(region, features));
}

std::vector<Pixel> circle(int vertices) {
  std::vector<Pixel> contour;
  for (int i = 0; i < vertices; ++i) {
    const Vec2 z = Vec2(128, 128) + std::polar(120.0, 2 * std::numbers::pi * i / vertices);
    contour.push_back({z.real(), z.imag()});
  }
  return contour;
}

TEST(Clusters, ArmsOfAHorseshoeAreGroups) {
  const Region region = make_region(horseshoe);
  EXPECT_EQ(cluster(region, {plane(15, 20), plane(241, 20), plane(5, 200), plane(251, 200)}),
            (std::vector<std::uint32_t>{0, 1, 0, 1}));
  // Two more at the base.
  EXPECT_EQ(cluster(region, {plane(10, 20), plane(10, 100), plane(100, 240), plane(150, 250), plane(245, 100),
                             plane(245, 20)}),
            (std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2}));
}

TEST(Clusters, AFeatureThatSeesNoneJoinsItsArtificialPartner) {
  const Region region = make_region(horseshoe);
  EXPECT_EQ(cluster(region, {plane(10, 20), plane(15, 100), plane(250, 20)}),
            (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(cluster(region, {plane(10, 20), plane(250, 20)}), (std::vector<std::uint32_t>{0, 0}));
}

TEST(Clusters, FewFeatures) {
  const Region region = make_region(horseshoe);
  EXPECT_TRUE(cluster(region, {}).empty());
  EXPECT_EQ(cluster(region, {plane(10, 20)}), (std::vector<std::uint32_t>{0}));
}

RC_GTEST_PROP(Clusters, ConvexRegionIsOneGroup, ()) {
  const Region region = make_region(circle(*rc::gen::inRange(3, 300)));
  const auto n = *rc::gen::element<std::size_t>(2, 3, 8, 20, 40);
  const auto group = cluster(region, points_in(region, n, *rc::gen::arbitrary<unsigned>()));
  RC_ASSERT(group == std::vector<std::uint32_t>(n, 0U));
}

RC_GTEST_PROP(Clusters, EveryFeatureHasAPartner, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 60), *rc::gen::arbitrary<unsigned>());
  const auto n = *rc::gen::element<std::uint32_t>(2, 3, 5, 10, 36);
  const std::vector<Vec2> features = points_in(region, n, *rc::gen::arbitrary<unsigned>());
  const FeatureGraph graph = build_feature_graph(region, features);
  const std::vector<std::uint32_t> group = cluster_features(region, features, graph);

  std::uint32_t next = 0;
  for (const std::uint32_t g : group) {
    RC_ASSERT(g <= next);
    next = std::max(next, g + 1);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    bool sees = false, has_partner = false;
    for (const FeaturePair p : graph.visible) {
      if (p[0] != i && p[1] != i) continue;
      sees = true;
      has_partner |= group[p[0]] == group[p[1]];
    }
    for (const FeaturePair p : graph.artificial) {
      if (!sees && (p[0] == i || p[1] == i)) has_partner |= group[p[0]] == group[p[1]];
    }
    RC_ASSERT(has_partner);
  }
}

RC_GTEST_PROP(Clusters, RenumberingRenumbersTheGroups, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 60), *rc::gen::arbitrary<unsigned>());
  const auto n = *rc::gen::element<std::uint32_t>(2, 5, 10, 36);
  const std::vector<Vec2> features = points_in(region, n, *rc::gen::arbitrary<unsigned>());
  std::vector<std::uint32_t> renumbered(n);
  std::iota(renumbered.begin(), renumbered.end(), 0U);
  std::shuffle(renumbered.begin(), renumbered.end(), std::mt19937(*rc::gen::arbitrary<unsigned>()));
  std::vector<Vec2> shuffled(n);
  for (std::uint32_t i = 0; i < n; ++i) shuffled[renumbered[i]] = features[i];
  const auto group = cluster(region, features), other = cluster(region, shuffled);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      RC_ASSERT((group[i] == group[j]) == (other[renumbered[i]] == other[renumbered[j]]));
    }
  }
}

}  // namespace
}  // namespace applique
