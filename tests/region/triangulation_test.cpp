#include "applique/region/triangulation.h"

#include <cmath>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "applique/base/predicates.h"

#include "region/contours.h"

namespace applique {
namespace {

/// A circle about (512, 512) as an image's alpha shows it: steps of one pixel.
std::vector<Pixel> stepped_circle(double radius) {
  std::vector<Pixel> quarter;
  for (int y = 0; y < radius; ++y) {
    const double x = std::floor(std::sqrt(radius * radius - y * y));
    quarter.push_back({x, static_cast<double>(y)});
    quarter.push_back({x, y + 1.0});
  }
  std::vector<Pixel> contour;
  for (int turn = 0; turn < 4; ++turn) {
    for (const Pixel p : quarter) {
      Vec2 z(p.x, p.y);
      for (int i = 0; i < turn; ++i) z *= Vec2(0, 1);
      const Pixel q = {512 + z.real(), 512 + z.imag()};
      if (!contour.empty() && contour.back().x == q.x && contour.back().y == q.y) continue;
      contour.push_back(q);
    }
  }
  return contour;
}

const std::vector<Pixel> square = {{0, 0}, {256, 0}, {256, 256}, {0, 256}};

/// Points of the region at random; some on a grid, some on the contour and its vertices.
std::vector<Vec2> features_in(const Region& region, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-1, 1);
  const auto& polygon = region.polygon();
  std::vector<Vec2> features;
  while (features.size() < count) {
    Vec2 z(x(random), x(random));
    if (features.size() % 3 == 1) z = Vec2(std::round(z.real() * 8), std::round(z.imag() * 8)) / 8.0;
    if (random() % 4 == 0) z = polygon[random() % polygon.size()];
    if (random() % 8 == 0) z = 0.5 * (polygon[0] + polygon[1]);
    if (region.contains(z) && std::find(features.begin(), features.end(), z) == features.end()) {
      features.push_back(z);
    }
  }
  return features;
}

double longest_edge(const RegionTriangulation& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, std::abs(mesh.points[t[k]] - mesh.points[t[(k + 1) % 3]]));
    }
  }
  return longest;
}

/// Why it is no constrained Delaunay triangulation of the region; empty if it is one.
std::string defect(const Region& region, std::span<const Vec2> features,
                   std::span<const FeaturePair> segments, const RegionTriangulation& mesh) {
  const auto& polygon = region.polygon();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (mesh.points[i] != polygon[i]) return "a vertex of the contour is not in its place";
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (mesh.points[mesh.features[i]] != features[i]) return "a feature is not in its place";
  }
  using Edge = std::array<std::uint32_t, 2>;
  std::map<Edge, std::int32_t> edges;
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    const Vec2 a = mesh.points[c[0]], b = mesh.points[c[1]], d = mesh.points[c[2]];
    if (orientation(a, b, d) <= 0) return "a triangle is not counter-clockwise";
    area += 0.5 * cross(b - a, d - a);
    for (int k = 0; k < 3; ++k) {
      if (!edges.insert({{c[(k + 1) % 3], c[(k + 2) % 3]}, mesh.neighbours[t][k]}).second) {
        return "an edge has two triangles on one side";
      }
    }
  }
  if (std::abs(area - region.area()) > 1e-12) return "the areas do not sum to the region's";

  std::set<Edge> fixed;
  std::size_t sides = 0;
  for (const auto& [edge, neighbour] : edges) {
    const auto opposite = edges.find({edge[1], edge[0]});
    if ((neighbour < 0) != (opposite == edges.end())) return "neighbours and edges disagree";
    if (neighbour < 0) ++sides;
  }
  // A disc: V - E + F = 1.
  const std::size_t edge_count = (edges.size() + sides) / 2;
  if (mesh.points.size() + mesh.triangles.size() != edge_count + 1) return "not a disc, or a point is unused";

  for (std::size_t s = 0; s < segments.size(); ++s) {
    const auto& chain = mesh.segments[s];
    if (chain.front() != mesh.features[segments[s][0]] || chain.back() != mesh.features[segments[s][1]]) {
      return "a segment has other ends";
    }
    const Vec2 a = features[segments[s][0]], b = features[segments[s][1]];
    for (std::size_t i = 1; i < chain.size(); ++i) {
      if (!edges.contains({chain[i - 1], chain[i]}) && !edges.contains({chain[i], chain[i - 1]})) {
        return "a piece of a segment is no edge";
      }
      const Vec2 z = mesh.points[chain[i]];
      if (std::abs(cross(z - a, b - a)) > 1e-14 * std::abs(b - a) ||
          dot(z - mesh.points[chain[i - 1]], b - a) <= 0) {
        return "a piece of a segment leaves it";
      }
      fixed.insert({chain[i - 1], chain[i]});
      fixed.insert({chain[i], chain[i - 1]});
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t u = mesh.neighbours[t][k];
      if (u < 0 || fixed.contains({c[(k + 1) % 3], c[(k + 2) % 3]})) continue;
      const auto& n = mesh.neighbours[u];
      const auto back = std::find(n.begin(), n.end(), static_cast<std::int32_t>(t));
      if (back == n.end()) return "a neighbour does not know it";
      if (in_circle(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]],
                    mesh.points[mesh.triangles[u][back - n.begin()]]) > 0) {
        return "an edge is not Delaunay";
      }
    }
  }
  return {};
}

RC_GTEST_PROP(Triangulation, IsConstrainedDelaunay, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 80), *rc::gen::arbitrary<unsigned>());
  const auto count = *rc::gen::element<std::size_t>(0, 1, 2, 5, 20);
  const std::vector<Vec2> features = features_in(region, count, *rc::gen::arbitrary<unsigned>());
  const FeatureGraph graph = build_feature_graph(region, features);
  for (const double max_edge : {0.0, region.diameter() / 10, region.diameter() / 40}) {
    const RegionTriangulation mesh = triangulate_region(region, features, graph.planar, {max_edge});
    const std::string found = defect(region, features, graph.planar, mesh);
    RC_ASSERT(found == "");
    if (max_edge == 0) continue;
    RC_ASSERT(longest_edge(mesh) <= max_edge * (1 + 1e-12));
    RC_ASSERT(mesh.points.size() < 20000U);
  }
}

TEST(Triangulation, CollinearFeaturesSegmentsAlongTheContour) {
  const Region region = make_region(square);
  const std::vector<Vec2> features = {plane(0, 0),   plane(128, 256), plane(64, 64),  plane(128, 128),
                                      plane(256, 0), plane(192, 192), plane(256, 256)};
  // The diagonal in one go, over three features; the lower side over one; the right side.
  const std::vector<FeaturePair> segments = {{0, 6}, {1, 6}, {4, 6}};
  for (const double max_edge : {0.0, 0.1}) {
    const RegionTriangulation mesh = triangulate_region(region, features, segments, {max_edge});
    EXPECT_EQ(defect(region, features, segments, mesh), "");
    if (max_edge == 0) {
      EXPECT_EQ(mesh.segments[0].size(), 5U);
    }
    EXPECT_LT(mesh.features[0], 4U) << "a vertex of the contour";
  }
}

TEST(Triangulation, ThinCorridorsAndNeedles) {
  const std::vector<std::vector<Pixel>> contours = {
      horseshoe,
      {{0, 0}, {256, 0.001}, {256, 0.002}, {0, 0.001}},
      {{0, 0}, {256, 0}, {256, 256}, {128, 1e-9}, {0, 256}},
      {{0, 0}, {100, 0}, {200, 0}, {256, 0}, {256, 256}, {200, 256}, {100, 256}, {0, 256}, {0, 128}}};
  for (const auto& contour : contours) {
    const Region region = make_region(contour);
    for (const double max_edge : {0.0, region.diameter() / 40}) {
      const RegionTriangulation mesh = triangulate_region(region, {}, {}, {max_edge});
      EXPECT_EQ(defect(region, {}, {}, mesh), "");
      if (max_edge > 0) {
        EXPECT_LE(longest_edge(mesh), max_edge * (1 + 1e-12));
      }
      EXPECT_LT(mesh.points.size(), 20000U);
    }
  }
}

TEST(Triangulation, FeaturesOnALineUpToRounding) {
  const Region region = make_region({{0, 0}, {250, 10}, {240, 250}, {10, 200}});
  const auto& polygon = region.polygon();
  std::vector<Vec2> features;
  for (const double t : {0.1, 0.3, 0.7, 0.9}) {
    const Vec2 on_side = polygon[1] + t * (polygon[2] - polygon[1]);
    for (const Vec2 z : {on_side, on_side + Vec2(1e-16, 0), on_side - Vec2(1e-16, 0)}) {
      if (!region.contains(z)) continue;
      features.push_back(z);
      break;
    }
    features.push_back(plane(20.1, 30.3) + t * (plane(220.7, 190.9) - plane(20.1, 30.3)));
  }
  const FeatureGraph graph = build_feature_graph(region, features);
  const double max_edge = region.diameter() / 40;
  const RegionTriangulation mesh = triangulate_region(region, features, graph.planar, {max_edge});
  EXPECT_EQ(defect(region, features, graph.planar, mesh), "");
  EXPECT_LE(longest_edge(mesh), max_edge * (1 + 1e-12));
}

TEST(Triangulation, TracedContourNeedsFewPoints) {
  const Region region = make_region(stepped_circle(470), {1000, 1000});
  const std::vector<Vec2> features = features_in(region, 20, 1);
  const FeatureGraph graph = build_feature_graph(region, features);
  const double max_edge = region.diameter() / 40;
  const RegionTriangulation mesh = triangulate_region(region, features, graph.planar, {max_edge});
  EXPECT_EQ(defect(region, features, graph.planar, mesh), "");
  EXPECT_LE(longest_edge(mesh), max_edge * (1 + 1e-12));
  EXPECT_LT(mesh.points.size(), region.polygon().size() + 3000);
}

}  // namespace
}  // namespace applique
