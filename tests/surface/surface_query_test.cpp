#include "applique/surface/surface_query.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace applique {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Vec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return {unit(random), unit(random), unit(random)};
}

/// Unconnected triangles of very different sizes.
SurfaceMesh make_soup(std::mt19937& random, std::uint32_t count) {
  std::vector<Vec3> positions;
  Triangles triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 centre = random_point(random);
    const double size = std::pow(10.0, -3 * std::abs(random_point(random).x()));
    for (int k = 0; k < 3; ++k) positions.push_back(centre + size * random_point(random));
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return weld_surface(positions, triangles);
}

/// A unit square in the plane z = 0 with n * n cells of two triangles.
SurfaceMesh make_grid(std::uint32_t n) {
  std::vector<Vec3> positions;
  Triangles triangles;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) positions.emplace_back(double(x) / n, double(y) / n, 0);
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x;
      triangles.push_back({a, a + 1, a + n + 2});
      triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return weld_surface(positions, triangles);
}

/// Distance to a segment, for a nearest point that shares no code with the query.
double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double s = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (a + s * d - p).norm();
}

double distance_to_triangle(const Vec3& p, const std::array<Vec3, 3>& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  bool inside = true;
  double edges = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3& a = t[k];
    const Vec3& b = t[(k + 1) % 3];
    inside = inside && (b - a).cross(p - a).dot(normal) >= 0;
    edges = std::min(edges, distance_to_segment(p, a, b));
  }
  return inside ? std::abs((p - t[0]).dot(normal)) : edges;
}

/// Möller and Trumbore's test; infinity for a miss.
double ray_parameter(const Vec3& origin, const Vec3& direction, const std::array<Vec3, 3>& t) {
  Eigen::Matrix3d system;
  system << -direction, t[1] - t[0], t[2] - t[0];
  const Vec3 solution = system.inverse() * (origin - t[0]);
  const bool hit = solution[0] >= 0 && solution[1] >= 0 && solution[2] >= 0 && solution[1] + solution[2] <= 1;
  return hit ? solution[0] : std::numeric_limits<double>::infinity();
}

void expect_convex(const SurfacePoint& point) {
  double sum = 0;
  for (const double weight : point.barycentric) {
    EXPECT_GE(weight, 0);
    sum += weight;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(SurfaceQuery, FindsTheNearestPointOfASoup) {
  std::mt19937 random(1);
  for (const std::uint32_t count : {1U, 3U, 5U, 64U, 700U}) {
    const SurfaceMesh mesh = make_soup(random, count);
    const SurfaceQuery query(mesh);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = 1.5 * random_point(random);
      double expected = std::numeric_limits<double>::infinity();
      for (const FaceId f : ids<FaceId>(mesh.faces.size()))
        expected = std::min(expected, distance_to_triangle(p, mesh.corners(f)));
      const SurfacePoint found = query.nearest(p);
      expect_convex(found);
      EXPECT_NEAR((position_of(mesh, found) - p).norm(), expected, 1e-12);
    }
  }
}

TEST(SurfaceQuery, FindsTheFirstHitInASoup) {
  std::mt19937 random(2);
  const SurfaceMesh mesh = make_soup(random, 500);
  const SurfaceQuery query(mesh);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = 2 * random_point(random);
    const Vec3 direction = 3 * random_point(random);
    double expected = std::numeric_limits<double>::infinity();
    for (const FaceId f : ids<FaceId>(mesh.faces.size()))
      expected = std::min(expected, ray_parameter(origin, direction, mesh.corners(f)));
    const auto found = query.first_hit(origin, direction);
    ASSERT_EQ(found.has_value(), std::isfinite(expected));
    if (!found) continue;
    ++hits;
    expect_convex(*found);
    EXPECT_NEAR((position_of(mesh, *found) - origin).norm(), expected * direction.norm(), 1e-9);
  }
  EXPECT_GT(hits, 100);
}

TEST(SurfaceQuery, TiesGoToTheLowestFace) {
  const SurfaceMesh mesh = make_grid(6);
  const SurfaceQuery query(mesh);
  for (const VertexId v : ids<VertexId>(mesh.positions.size())) {
    FaceId lowest;
    for (const FaceId f : ids<FaceId>(mesh.faces.size()))
      for (const VertexId corner : mesh.faces[f])
        if (corner == v && !lowest.valid()) lowest = f;
    EXPECT_EQ(query.nearest(mesh.positions[v] + Vec3(0, 0, 0.25)).face, lowest);
  }
}

TEST(SurfaceQuery, RaysDoNotSlipThroughEdgesAndVertices) {
  const SurfaceMesh mesh = make_grid(7);
  const SurfaceQuery query(mesh);
  std::mt19937 random(3);
  for (int y = 1; y < 14; ++y)
    for (int x = 1; x < 14; ++x) {
      const Vec3 target(x / 14.0, y / 14.0, 0);
      const Vec3 origin = target + Vec3(0, 0, 3);
      ASSERT_TRUE(query.first_hit(origin, Vec3(0, 0, -2)).has_value()) << x << ", " << y;
      Vec3 oblique = random_point(random);
      oblique.z() = 1 + std::abs(oblique.z());
      ASSERT_TRUE(query.first_hit(target + oblique, -oblique).has_value()) << x << ", " << y;
    }
}

TEST(SurfaceQuery, HitsFromEitherSideAndOnlyAhead) {
  const SurfaceMesh mesh = make_grid(2);
  const SurfaceQuery query(mesh);
  EXPECT_TRUE(query.first_hit({0.3, 0.4, 1}, {0, 0, -1}).has_value());
  EXPECT_TRUE(query.first_hit({0.3, 0.4, -1}, {0, 0, 5}).has_value());
  EXPECT_FALSE(query.first_hit({0.3, 0.4, 1}, {0, 0, 1}).has_value());
  EXPECT_FALSE(query.first_hit({1.3, 0.4, 1}, {0, 0, -1}).has_value());
}

TEST(SurfaceQuery, IsBuiltFast) {
  const SurfaceMesh mesh = make_grid(224);  // 100k faces.
  const auto start = std::chrono::steady_clock::now();
  const SurfaceQuery query(mesh);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const Vec3 target(x / 39.0, y / 39.0, 0);
      EXPECT_NEAR((position_of(mesh, query.nearest(target + Vec3(0, 0, 1))) - target).norm(), 0, 1e-12);
    }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("milliseconds", static_cast<int>(1000 * seconds));
#ifdef NDEBUG
  EXPECT_LT(seconds, 1) << "that takes some 0.03 s; far more means that it is no longer O(n log n)";
#endif
}

}  // namespace
}  // namespace applique
