#include "applique/region/region.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "applique/base/predicates.h"

namespace applique {
namespace {

constexpr ImageFrame frame = {256, 128};  // Whole pixels are exact in the plane.

Region make_region(const std::vector<Pixel>& contour, const ImageFrame& image_frame = frame) {
  auto region = Region::from_contour(contour, image_frame);
  EXPECT_TRUE(region) << region.error().message;
  return std::move(*region);
}

Vec2 plane(double x, double y) {
  return frame.to_plane({x, y});
}

/// A simple polygon around (100, 50): radii between 10 and 48 px at ascending angles.
std::vector<Pixel> star_contour(int vertices, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(10, 48);
  std::vector<Pixel> contour;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2 * std::numbers::pi * i / vertices;
    const double r = radius(random);
    contour.push_back({100 + r * std::cos(angle), 50 + r * std::sin(angle)});
  }
  return contour;
}

/// A square spiral corridor 2 px wide.
std::vector<Pixel> spiral_contour(int turns) {
  std::vector<Pixel> outer, inner;
  for (int i = 0; i < 4 * turns; ++i) {
    const double r = 2 + 2 * (i / 4) + (i % 4 == 3 ? 2 : 0);
    const double x = (i % 4 == 0 || i % 4 == 3) ? -1 : 1, y = i % 4 < 2 ? -1 : 1;
    outer.push_back({100 + x * (r + 0.5), 50 + y * (r + 0.5)});
    inner.push_back({100 + x * (r - 0.5), 50 + y * (r - 0.5)});
  }
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return outer;
}

// The definition, edge by edge: on the contour, or an odd number of edges to the right.
bool contains_by_definition(const std::vector<Vec2>& polygon, Vec2 z) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const int side = orientation(p, q, z);
    if (side == 0 && dot(z - p, z - q) <= 0) return true;
    if ((p.imag() > z.imag()) != (q.imag() > z.imag()) && (side > 0) == (q.imag() > p.imag()))
      inside = !inside;
  }
  return inside;
}

double distance_by_definition(const std::vector<Vec2>& polygon, Vec2 z) {
  double best = 1e300;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 p = polygon[i], d = polygon[(i + 1) % polygon.size()] - p;
    best = std::min(best, std::abs(z - p - std::clamp(dot(z - p, d) / std::norm(d), 0.0, 1.0) * d));
  }
  return best;
}

TEST(Region, KeepsTheContourInBothOrientations) {
  const std::vector<Pixel> contour = {
      {10, 10}, {10, 90}, {190, 90}, {190, 10}};  // Anticlockwise on the screen.
  const Region given = make_region(contour);
  const Region turned = make_region({contour.rbegin(), contour.rend()});
  for (const Region* region : {&given, &turned}) {
    double twice_area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      twice_area += cross(region->polygon()[i], region->polygon()[(i + 1) % 4]);
      EXPECT_EQ(frame.to_plane(region->contour()[i]), region->polygon()[i]);
    }
    EXPECT_NEAR(twice_area, 2 * 180 * 80 / (128.0 * 128), 1e-12);
    EXPECT_NEAR(region->area(), 180 * 80 / (128.0 * 128), 1e-12);
    EXPECT_NEAR(region->diameter(), std::hypot(180, 80) / 128, 1e-12);
  }
}

TEST(Region, DropsRepeatedVertices) {
  const Region region = make_region({{10, 10}, {10, 10}, {50, 10}, {50, 50}, {50, 50}, {50, 50}, {10, 10}});
  EXPECT_EQ(region.polygon().size(), 3U);
}

TEST(Region, NamesWhereTheContourCrossesItself) {
  const auto bow_tie = Region::from_contour({{10, 10}, {90, 90}, {90, 10}, {10, 90}}, frame);
  ASSERT_FALSE(bow_tie);
  EXPECT_EQ(bow_tie.error().code, ErrorCode::contour_self_crossing);
  EXPECT_NE(bow_tie.error().message.find("at (50.00, 50.00) px"), std::string::npos)
      << bow_tie.error().message;
  EXPECT_NE(bow_tie.error().message.find("(10, 10)-(90, 90)"), std::string::npos) << bow_tie.error().message;
  EXPECT_NE(bow_tie.error().message.find("(90, 10)-(10, 90)"), std::string::npos) << bow_tie.error().message;

  const std::vector<std::vector<Pixel>> others = {
      {{0, 0}, {100, 0}, {100, 50}, {50, 0}, {0, 50}},             // A vertex on another edge.
      {{0, 0}, {50, 50}, {100, 0}, {100, 99}, {50, 50}, {0, 99}},  // Two vertices on one spot.
      {{0, 0}, {100, 0}, {40, 0}, {40, 50}},                       // Folded back.
      {{0, 0}, {60, 0}, {60, 50}, {50, 50}, {50, 0}, {10, 0}, {10, 50}, {0, 50}},  // Along itself.
  };
  for (const auto& contour : others) {
    const auto region = Region::from_contour(contour, frame);
    ASSERT_FALSE(region);
    EXPECT_EQ(region.error().code, ErrorCode::contour_self_crossing) << region.error().message;
  }
}

TEST(Region, TurnsDownWhatEnclosesNothing) {
  const std::vector<std::vector<Pixel>> contours = {{},
                                                    {{1, 1}},
                                                    {{1, 1}, {5, 5}},
                                                    {{1, 1}, {5, 5}, {1, 1}},
                                                    {{0, 0}, {50, 50}, {100, 100}, {20, 20}},
                                                    {{0, 0}, {std::nan(""), 3}, {3, 3}}};
  for (const auto& contour : contours) {
    const auto region = Region::from_contour(contour, frame);
    ASSERT_FALSE(region);
    EXPECT_EQ(region.error().code, ErrorCode::region_empty) << region.error().message;
  }
}

RC_GTEST_PROP(Region, ContainsIsClosedAndExact, ()) {
  const int vertices = *rc::gen::inRange(3, 60);
  const Region region = make_region(star_contour(vertices, *rc::gen::arbitrary<unsigned>()));
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  std::uniform_real_distribution<double> x(-1.1, 1.1), t(0, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec2 z(x(random), 0.5 * x(random));
    RC_ASSERT(region.contains(z) == contains_by_definition(region.polygon(), z));
    const Vec2 p = region.polygon()[random() % vertices], q = region.polygon()[random() % vertices];
    RC_ASSERT(region.contains(p));
    const Vec2 level(z.real(), p.imag());  // On a line with a vertex.
    RC_ASSERT(region.contains(level) == contains_by_definition(region.polygon(), level));
    const Vec2 near = p + t(random) * (q - p);
    RC_ASSERT(region.contains(near) == contains_by_definition(region.polygon(), near));
    RC_ASSERT(std::abs(std::abs(region.signed_distance(z)) - distance_by_definition(region.polygon(), z)) <
              1e-12);
    RC_ASSERT((region.signed_distance(z) >= 0) == region.contains(z));
  }
}

TEST(Region, SegmentsMayRunAlongTheContour) {
  // A U: two arms and a base.
  const Region region =
      make_region({{10, 10}, {40, 10}, {40, 60}, {70, 60}, {70, 10}, {100, 10}, {100, 90}, {10, 90}});
  EXPECT_TRUE(region.contains_segment(plane(10, 10), plane(40, 10)));  // An edge.
  EXPECT_TRUE(
      region.contains_segment(plane(10, 60), plane(100, 60)));  // Through two vertices, along an edge.
  EXPECT_TRUE(region.contains_segment(plane(40, 60), plane(70, 60)));
  EXPECT_TRUE(region.contains_segment(plane(50, 60), plane(60, 60)));  // Part of an edge.
  EXPECT_TRUE(region.contains_segment(plane(40, 20), plane(40, 80)));  // Along an edge, then inside.
  EXPECT_TRUE(region.contains_segment(plane(20, 20), plane(20, 80)));
  EXPECT_TRUE(region.contains_segment(plane(30, 50), plane(50, 70)));  // Touches the vertex (40, 60).
  EXPECT_TRUE(region.contains_segment(plane(100, 10), plane(100, 90)));
  EXPECT_TRUE(region.contains_segment(plane(20, 20), plane(20, 20)));
  EXPECT_FALSE(region.contains_segment(plane(10, 10), plane(100, 10)));  // Over the gap, along two edges.
  EXPECT_FALSE(region.contains_segment(plane(20, 20), plane(90, 20)));
  EXPECT_FALSE(region.contains_segment(plane(40, 10), plane(70, 10)));  // From vertex to vertex outside.
  EXPECT_FALSE(region.contains_segment(plane(40, 20), plane(70, 30)));  // From edge to edge outside.
  EXPECT_FALSE(region.contains_segment(plane(20, 20), plane(20, 95)));
  EXPECT_FALSE(region.contains_segment(plane(150, 20), plane(160, 20)));

  EXPECT_TRUE(region.meets_segment(plane(0, 20), plane(190, 20)));
  EXPECT_TRUE(region.meets_segment(plane(45, 20), plane(60, 90)));
  EXPECT_TRUE(region.meets_segment(plane(10, 10), plane(40, 40)));  // From a corner inwards.
  EXPECT_TRUE(region.meets_segment(plane(50, 60), plane(50, 61)));
  EXPECT_FALSE(region.meets_segment(plane(10, 10), plane(40, 10)));  // An edge has no inner point.
  EXPECT_FALSE(region.meets_segment(plane(0, 10), plane(190, 10)));
  EXPECT_FALSE(region.meets_segment(plane(40, 20), plane(70, 30)));
  EXPECT_FALSE(region.meets_segment(plane(0, 20), plane(20, 0)));  // Touches the corner from outside.
  EXPECT_FALSE(region.meets_segment(plane(50, 20), plane(60, 50)));
}

TEST(Region, TrianglesMeetTheInterior) {
  const Region region = make_region({{40, 40}, {60, 40}, {60, 60}, {40, 60}});
  EXPECT_TRUE(region.meets_triangle(plane(0, 0), plane(0, 200), plane(200, 0)));     // Around it.
  EXPECT_TRUE(region.meets_triangle(plane(0, 0), plane(200, 0), plane(0, 200)));     // The other way round.
  EXPECT_TRUE(region.meets_triangle(plane(50, 50), plane(51, 50), plane(50, 51)));   // Within.
  EXPECT_TRUE(region.meets_triangle(plane(40, 40), plane(60, 40), plane(60, 60)));   // Its half.
  EXPECT_TRUE(region.meets_triangle(plane(0, 50), plane(100, 50), plane(50, 99)));   // Across.
  EXPECT_TRUE(region.meets_triangle(plane(50, 50), plane(52, 50), plane(54, 50)));   // A line inside.
  EXPECT_FALSE(region.meets_triangle(plane(40, 40), plane(60, 40), plane(50, 10)));  // Shares an edge.
  EXPECT_FALSE(region.meets_triangle(plane(0, 40), plane(100, 40), plane(50, 10)));
  EXPECT_FALSE(region.meets_triangle(plane(60, 60), plane(90, 60), plane(60, 90)));  // Shares a corner.
  EXPECT_FALSE(region.meets_triangle(plane(70, 0), plane(90, 0), plane(70, 90)));
  const Region triangle = make_region({{40, 40}, {60, 40}, {60, 60}});
  EXPECT_TRUE(triangle.meets_triangle(triangle.polygon()[0], triangle.polygon()[1], triangle.polygon()[2]));
}

RC_GTEST_PROP(Region, SegmentAnswersAgreeWithSamples, ()) {
  const Region region = make_region(star_contour(*rc::gen::inRange(3, 40), *rc::gen::arbitrary<unsigned>()));
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  std::uniform_real_distribution<double> x(-0.5, 0.5);
  for (int i = 0; i < 50; ++i) {
    const Vec2 a(x(random), x(random)), b = a + 0.3 * Vec2(x(random), x(random)), c(x(random), x(random));
    bool all = true, any = false, meets = false;
    for (int k = 0; k <= 200; ++k) {
      const bool inside = region.contains(a + k / 200.0 * (b - a));
      all &= inside;
      any |= inside;
      for (int l = 0; l <= k && !meets; l += 20)
        meets = region.contains(c + k / 200.0 * (a - c) + l / 200.0 * (b - a));
    }
    if (region.contains_segment(a, b)) RC_ASSERT(all);
    if (any) RC_ASSERT(region.meets_segment(a, b));
    if (!region.meets_segment(a, b)) RC_ASSERT(!any);
    if (meets) RC_ASSERT(region.meets_triangle(a, b, c));
    if (!region.meets_triangle(a, b, c)) RC_ASSERT(!any);
    RC_ASSERT(region.contains_segment(a, b) == region.contains_segment(b, a));
    RC_ASSERT(region.meets_triangle(a, b, c) == region.meets_triangle(c, b, a));
  }
}

TEST(Region, CorridorsThinnerThanCellsStayClosed) {
  const Region region = make_region(spiral_contour(10));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-0.25, 0.25);
  for (int i = 0; i < 20000; ++i) {
    const Vec2 z(x(random), x(random));
    ASSERT_EQ(region.contains(z), contains_by_definition(region.polygon(), z)) << z;
  }
  const Region needle = make_region({{1, 50}, {199, 50.001}, {199, 50.002}});
  EXPECT_TRUE(needle.contains(plane(190, 50.0015)));
  EXPECT_FALSE(needle.contains(plane(190, 50.1)));
}

TEST(Region, LargeContoursAreCheckedOnceAndAsked) {
  const Region region = make_region(star_contour(5000, 3));
  EXPECT_EQ(region.polygon().size(), 5000U);
  auto crossed = star_contour(5000, 3);
  std::swap(crossed[2000], crossed[2001]);
  const auto error = Region::from_contour(crossed, frame);
  ASSERT_FALSE(error);
  EXPECT_EQ(error.error().code, ErrorCode::contour_self_crossing);
}

}  // namespace
}  // namespace applique
