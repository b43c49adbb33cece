#include "applique/paper/convex_graph.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "applique/base/predicates.h"

namespace applique {
namespace {

constexpr ImageFrame frame{512, 512};

std::vector<Vec2> in_plane(const std::vector<Pixel>& pixels) {
  std::vector<Vec2> points;
  for (const Pixel& p : pixels) points.push_back(frame.to_plane(p));
  return points;
}

ConvexGraph graph_of(const std::vector<Pixel>& contour, const std::vector<Pixel>& features) {
  const Region region = *Region::from_contour(contour, frame);
  return build_convex_graph(in_plane(features), build_feature_graph(region, in_plane(features)));
}

double area_of(const std::vector<Vec2>& features, const std::vector<std::uint32_t>& face) {
  double area = 0;
  for (std::size_t i = 0; i < face.size(); ++i)
    area += 0.5 * cross(features[face[i]], features[face[(i + 1) % face.size()]]);
  return area;
}

void expect_convex(const std::vector<Vec2>& features, const ConvexGraph& graph) {
  for (const auto& face : graph.faces)
    for (std::size_t i = 0; i < face.size(); ++i)
      EXPECT_GE(orientation(features[face[i]], features[face[(i + 1) % face.size()]],
                            features[face[(i + 2) % face.size()]]),
                0);
}

const std::vector<Pixel> square = {{0, 0}, {512, 0}, {512, 512}, {0, 512}};

TEST(ConvexGraph, OfAConvexOutlineIsOneFaceWithTheInnerFeaturesIsolated) {
  const std::vector<Pixel> features = {{100, 100}, {400, 100}, {410, 400}, {90, 420}, {250, 260}, {300, 200}};
  const ConvexGraph graph = graph_of(square, features);
  ASSERT_EQ(graph.faces.size(), 1u);
  EXPECT_EQ(graph.faces[0].size(), 4u);
  EXPECT_GT(area_of(in_plane(features), graph.faces[0]), 0);
  EXPECT_EQ(graph.edges, (std::vector<FeaturePair>{{0, 1}, {0, 3}, {1, 2}, {2, 3}}));
  EXPECT_TRUE(graph.bridges.empty());
  ASSERT_EQ(graph.isolated.size(), 2u);
  EXPECT_EQ(graph.isolated[0].feature, 4u);
  EXPECT_EQ(graph.isolated[1].feature, 5u);
}

TEST(ConvexGraph, CutsAnAngleInTwo) {
  const std::vector<Pixel> contour = {{0, 0}, {200, 0}, {200, 300}, {512, 300}, {512, 512}, {0, 512}};
  const std::vector<Pixel> features = {{20, 20}, {180, 20}, {190, 310}, {490, 320}, {490, 490}, {20, 490}};
  const ConvexGraph graph = graph_of(contour, features);
  EXPECT_EQ(graph.faces.size(), 2u);
  EXPECT_EQ(graph.edges.size(), 7u);
  EXPECT_TRUE(graph.bridges.empty());
  expect_convex(in_plane(features), graph);
}

TEST(ConvexGraph, CutsAStarIntoConvexFacesThatCoverIt) {
  std::vector<Pixel> contour, features;
  for (int k = 0; k < 10; ++k) {
    const double angle = std::numbers::pi * (0.2 * k - 0.5);
    const Vec2 way = std::polar(k % 2 == 0 ? 250.0 : 110.0, angle);
    contour.push_back({256 + way.real(), 256 + way.imag()});
    features.push_back({256 + 0.9 * way.real(), 256 + 0.9 * way.imag()});
  }
  const ConvexGraph graph = graph_of(contour, features);
  const std::vector<Vec2> places = in_plane(features);
  expect_convex(places, graph);
  double area = 0, outline = 0;
  for (const auto& face : graph.faces) area += area_of(places, face);
  for (std::size_t k = 0; k < 10; ++k) outline += 0.5 * cross(places[(k + 1) % 10], places[k]);
  EXPECT_NEAR(area, outline, 1e-12);
  // Five reflex corners: at least three cuts. Hertel and Mehlhorn leave at most one per reflex corner twice.
  EXPECT_GE(graph.faces.size(), 4u);
  EXPECT_LE(graph.faces.size(), 6u);
}

TEST(ConvexGraph, KeepsEdgesOnNoFaceAsBridges) {
  // Two triangles, joined by one edge through a neck.
  const std::vector<Pixel> contour = {{0, 100},   {200, 245}, {312, 245}, {512, 100},
                                      {512, 412}, {312, 267}, {200, 267}, {0, 412}};
  const std::vector<Pixel> features = {{20, 150}, {20, 360}, {180, 256}, {332, 256}, {490, 150}, {490, 360}};
  const ConvexGraph graph = graph_of(contour, features);
  EXPECT_EQ(graph.faces.size(), 2u);
  EXPECT_EQ(graph.bridges, (std::vector<FeaturePair>{{2, 3}}));
  EXPECT_EQ(graph.edges.size(), 7u);
}

TEST(ConvexGraph, OfFeaturesInALineIsAChainOfBridges) {
  const ConvexGraph graph = graph_of(square, {{100, 256}, {400, 256}, {250, 256}});
  EXPECT_TRUE(graph.faces.empty());
  EXPECT_EQ(graph.bridges, (std::vector<FeaturePair>{{0, 2}, {1, 2}}));
}

}  // namespace
}  // namespace applique
