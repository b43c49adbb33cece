#include "applique/region/feature_graph.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "applique/base/predicates.h"
#include "applique/region/geodesic.h"

#include "region/contours.h"

namespace applique {
namespace {

const std::vector<Pixel> square = {{0, 0}, {256, 0}, {256, 256}, {0, 256}};

TEST(FeatureGraph, SquareOfFeatures) {
  const FeatureGraph graph =
      build_feature_graph(make_region(square), {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.6}, {-0.5, 0.5}});
  EXPECT_EQ(graph.visible.size(), 6U);
  EXPECT_EQ(graph.planar.size(), 5U);
  EXPECT_EQ(graph.triangles.size(), 2U);
  EXPECT_EQ(graph.tree.size(), 3U);
  EXPECT_TRUE(graph.artificial.empty());
}

TEST(FeatureGraph, CollinearFeaturesMakeAChain) {
  const FeatureGraph graph =
      build_feature_graph(make_region(square), {{0.5, 0}, {-0.5, 0}, {0.25, 0}, {0, 0}});
  EXPECT_EQ(graph.visible.size(), 6U);
  EXPECT_EQ(graph.planar, (std::vector<FeaturePair>{{0, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(graph.tree, graph.planar);
  EXPECT_TRUE(graph.triangles.empty());
}

TEST(FeatureGraph, OneAndTwoFeatures) {
  const Region region = make_region(square);
  EXPECT_TRUE(build_feature_graph(region, {{0, 0}}).visible.empty());
  const FeatureGraph two = build_feature_graph(region, {{0, 0}, {0.5, 0.5}});
  EXPECT_EQ(two.visible, (std::vector<FeaturePair>{{0, 1}}));
  EXPECT_EQ(two.tree, two.visible);
}

TEST(FeatureGraph, TakesTheShortDiagonal) {
  const FeatureGraph graph =
      build_feature_graph(make_region(square), {{-0.9, 0}, {0, 0.45}, {0.9, 0}, {0, -0.44}});
  EXPECT_TRUE(std::binary_search(graph.planar.begin(), graph.planar.end(), FeaturePair{1, 3}));
}

TEST(FeatureGraph, WhatSeesNothingIsJoinedTheShortestWayInside) {
  const Region region = make_region(horseshoe);
  const auto at = [&](double x, double y) { return contour_frame.to_plane({x, y}); };
  // Two in the left arm, two in the right. Straight across 0 and 2 are nearest, by the base 1 and 3.
  const FeatureGraph graph = build_feature_graph(region, {at(15, 20), at(5, 200), at(241, 20), at(251, 200)});
  EXPECT_EQ(graph.visible, (std::vector<FeaturePair>{{0, 1}, {2, 3}}));
  EXPECT_EQ(graph.artificial, (std::vector<FeaturePair>{{1, 3}}));
  EXPECT_EQ(graph.tree, (std::vector<FeaturePair>{{0, 1}, {1, 3}, {2, 3}}));
}

// Shortest inner path by the definition: Dijkstra over everything that sees each other.
double geodesic_by_definition(const Region& region, Vec2 a, Vec2 b) {
  std::vector<Vec2> nodes = region.polygon();
  nodes.push_back(a);
  nodes.push_back(b);
  std::vector<double> length(nodes.size(), 1e300);
  std::vector<char> done(nodes.size(), 0);
  length[nodes.size() - 2] = 0;
  for (std::size_t step = 0; step < nodes.size(); ++step) {
    std::size_t i = 0;
    double least = 1e301;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!done[k] && length[k] < least) least = length[i = k];
    }
    done[i] = 1;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!done[k] && region.contains_segment(nodes[i], nodes[k])) {
        length[k] = std::min(length[k], length[i] + std::abs(nodes[k] - nodes[i]));
      }
    }
  }
  return length.back();
}

RC_GTEST_PROP(InnerGeodesics, AreShortest, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 40), *rc::gen::arbitrary<unsigned>());
  std::vector<Vec2> points = points_in(region, 5, *rc::gen::arbitrary<unsigned>());
  points.push_back(region.polygon()[0]);
  points.push_back(region.polygon()[2]);
  points.push_back(0.5 * (region.polygon()[0] + region.polygon()[1]));
  const InnerGeodesics geodesics(region.polygon(), points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec2 a = points[k];
    const auto lengths = geodesics.lengths(k);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!region.contains(a) || !region.contains(points[i])) continue;  // The middle of an edge is rounded.
      const double expected = a == points[i] ? 0 : geodesic_by_definition(region, a, points[i]);
      RC_ASSERT(std::abs(lengths[i] - expected) < 1e-9);
    }
  }
}

RC_GTEST_PROP(FeatureGraph, Properties, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 60), *rc::gen::arbitrary<unsigned>());
  const auto n = *rc::gen::element<std::uint32_t>(2, 3, 5, 10, 20, 40);
  const std::vector<Vec2> f = points_in(region, n, *rc::gen::arbitrary<unsigned>());
  const FeatureGraph graph = build_feature_graph(region, f);

  for (const auto* list : {&graph.visible, &graph.artificial, &graph.planar, &graph.tree}) {
    RC_ASSERT(std::is_sorted(list->begin(), list->end()));
    for (const FeaturePair p : *list) RC_ASSERT(p[0] < p[1] && p[1] < n);
  }
  const std::set<FeaturePair> visible(graph.visible.begin(), graph.visible.end());
  for (const FeaturePair p : visible) RC_ASSERT(region.contains_segment(f[p[0]], f[p[1]]));
  for (const FeaturePair p : graph.artificial) RC_ASSERT(!region.contains_segment(f[p[0]], f[p[1]]));
  for (const FeaturePair p : graph.planar) {
    RC_ASSERT(visible.count(p) == 1U);
    for (const FeaturePair q : graph.planar) {
      RC_ASSERT(!(orientation(f[p[0]], f[p[1]], f[q[0]]) * orientation(f[p[0]], f[p[1]], f[q[1]]) < 0 &&
                  orientation(f[q[0]], f[q[1]], f[p[0]]) * orientation(f[q[0]], f[q[1]], f[p[1]]) < 0));
    }
  }
  // A spanning tree.
  RC_ASSERT(graph.tree.size() == n - 1U);
  std::vector<std::uint32_t> label(n);
  std::iota(label.begin(), label.end(), 0U);
  for (const FeaturePair p : graph.tree) {
    RC_ASSERT(label[p[0]] != label[p[1]]);
    std::replace(label.begin(), label.end(), std::uint32_t{label[p[1]]}, std::uint32_t{label[p[0]]});
  }
  // Triangles are counter-clockwise, inside, empty; shared edges are Delaunay.
  for (const auto& t : graph.triangles) {
    RC_ASSERT(orientation(f[t[0]], f[t[1]], f[t[2]]) > 0);
    for (const auto& u : graph.triangles) {
      std::vector<std::uint32_t> rest;
      for (const std::uint32_t k : u) {
        if (std::find(t.begin(), t.end(), k) == t.end()) rest.push_back(k);
      }
      if (rest.size() == 1) {
        const bool convex = in_circle(f[t[0]], f[t[1]], f[t[2]], f[rest[0]]) <= 0;
        RC_ASSERT(convex);
      }
    }
  }
}

RC_GTEST_PROP(FeatureGraph, RenumberingRenumbersTheResult, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 60), *rc::gen::arbitrary<unsigned>());
  const auto n = *rc::gen::element<std::uint32_t>(4, 10, 36);
  std::vector<Vec2> f = points_in(region, n, *rc::gen::arbitrary<unsigned>());
  // Equal lengths, too: a grid.
  for (Vec2& z : f) {
    const Vec2 snapped = Vec2(std::round(z.real() * 8), std::round(z.imag() * 8)) / 8.0;
    if (region.contains(snapped) && std::find(f.begin(), f.end(), snapped) == f.end()) z = snapped;
  }
  std::vector<std::uint32_t> renumbered(n);
  std::iota(renumbered.begin(), renumbered.end(), 0U);
  std::shuffle(renumbered.begin(), renumbered.end(), std::mt19937(*rc::gen::arbitrary<unsigned>()));
  std::vector<Vec2> shuffled(n);
  for (std::uint32_t i = 0; i < n; ++i) shuffled[renumbered[i]] = f[i];
  const FeatureGraph graph = build_feature_graph(region, f), other = build_feature_graph(region, shuffled);
  const auto renumber = [&](std::vector<FeaturePair> pairs) {
    for (FeaturePair& p : pairs) {
      p = {renumbered[p[0]], renumbered[p[1]]};
      std::sort(p.begin(), p.end());
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  };
  RC_ASSERT(renumber(graph.visible) == other.visible);
  RC_ASSERT(renumber(graph.artificial) == other.artificial);
  RC_ASSERT(renumber(graph.planar) == other.planar);
  RC_ASSERT(renumber(graph.tree) == other.tree);
  RC_ASSERT(graph.triangles.size() == other.triangles.size());
}

}  // namespace
}  // namespace applique
