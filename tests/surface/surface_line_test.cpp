#include "applique/surface/surface_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace applique {
namespace {

/// How far a point is from lying in a face: by how much the triangles that it makes with the sides exceed it.
double off_face(const SurfaceMesh& mesh, FaceId f, const Vec3& p) {
  const auto [a, b, c] = mesh.corners(f);
  const double whole = (b - a).cross(c - a).norm();
  return ((a - p).cross(b - p).norm() + (b - p).cross(c - p).norm() + (c - p).cross(a - p).norm()) / whole -
         1;
}

/// Every piece lies in its face, and the faces are neighbours.
void expect_on_surface(const SurfaceMesh& mesh, const SurfaceLine& line) {
  ASSERT_EQ(line.points.size(), line.faces.size() + 1);
  for (std::size_t i = 0; i < line.faces.size(); ++i) {
    for (const Vec3& p : {line.points[i], line.points[i + 1]})
      EXPECT_LT(off_face(mesh, line.faces[i], p), 1e-9);
    if (i == 0) continue;
    const auto& across = mesh.neighbours[line.faces[i - 1]];
    EXPECT_NE(std::find(across.begin(), across.end(), line.faces[i]), across.end());
  }
}

/// A place inside a face.
SurfacePoint random_point(const SurfaceMesh& mesh, std::mt19937& random) {
  std::uniform_int_distribution<std::size_t> face(0, mesh.faces.size() - 1);
  std::uniform_real_distribution<double> weight(0.1, 1);
  SurfacePoint point{FaceId(face(random)), {weight(random), weight(random), weight(random)}};
  const double sum = point.barycentric[0] + point.barycentric[1] + point.barycentric[2];
  for (double& w : point.barycentric) w /= sum;
  return point;
}

TEST(GeodesicBetween, IsStraightOnAPlane) {
  const SurfaceMesh mesh = shapes::plane(30, 30, 3, 3, 0.3).weld();
  std::mt19937 random(1);
  for (int trial = 0; trial < 40; ++trial) {
    const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
    const SurfaceLine line = geodesic_between(mesh, a, b);
    EXPECT_NEAR(line.length(), (position_of(mesh, a) - position_of(mesh, b)).norm(), 1e-12);
    expect_on_surface(mesh, line);
  }
}

/// A tube of flat strips, unrolled: how far round its faces a point is, from the x axis on.
double around(const Vec3& p, int sides, double radius) {
  const double step = 2 * std::numbers::pi / sides, angle = std::atan2(p.y(), p.x());
  const double from_middle = angle - (std::floor(angle / step) + 0.5) * step;
  const double apothem = radius * std::cos(0.5 * step);
  return 2 * radius * std::sin(0.5 * step) * (std::floor(angle / step) + 0.5) +
         apothem * std::tan(from_middle);
}

TEST(GeodesicBetween, IsAHelixOnACylinder) {
  constexpr int sides = 40;
  const SurfaceMesh mesh = shapes::cylinder(sides, 30, 1, 4).weld();
  std::mt19937 random(2);
  int trials = 0;
  while (trials < 20) {
    const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
    const Vec3 p = position_of(mesh, a), q = position_of(mesh, b);
    const double across = around(q, sides, 1) - around(p, sides, 1);
    if (std::abs(across) > 2.5) continue;  // which way round is shorter must be plain
    ++trials;
    EXPECT_NEAR(geodesic_between(mesh, a, b).length(), std::hypot(across, q.z() - p.z()), 1e-9);
  }
}

/// Where the strip is taken over several vertices at once, what it turns over at one is not there at the
/// next.
TEST(GeodesicBetween, IsOnTheSurfaceAmongSpikes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> height(0, 0.4);
  shapes::Soup soup = shapes::plane(24, 24, 3, 3, 0.2);
  for (Vec3& p : soup.positions) p.z() = height(random);
  const SurfaceMesh mesh = soup.weld();
  for (int trial = 0; trial < 200; ++trial) {
    const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
    const SurfaceLine line = geodesic_between(mesh, a, b);
    expect_on_surface(mesh, line);
    EXPECT_GE(line.length(), (position_of(mesh, a) - position_of(mesh, b)).norm() - 1e-12);
  }
}

TEST(GeodesicBetween, NearsTheGreatCircle) {
  const SurfaceMesh mesh = shapes::sphere(4, 1).weld();
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const SurfacePoint a = random_point(mesh, random), b = random_point(mesh, random);
    const Vec3 p = position_of(mesh, a), q = position_of(mesh, b);
    const SurfaceLine line = geodesic_between(mesh, a, b);
    EXPECT_NEAR(line.length() / std::atan2(p.cross(q).norm(), p.dot(q)), 1, 3e-3);
    expect_on_surface(mesh, line);
  }
}

TEST(GeodesicBetween, HasNoWayBetweenParts) {
  shapes::Soup soup = shapes::plane(2, 2, 1, 1);
  const shapes::Soup other = shapes::plane(2, 2, 1, 1);
  const auto shift = static_cast<std::uint32_t>(soup.positions.size());
  for (const Vec3& p : other.positions) soup.positions.emplace_back(p + Vec3(5, 0, 0));
  for (const auto& [a, b, c] : other.triangles) soup.triangles.push_back({a + shift, b + shift, c + shift});
  const SurfaceMesh mesh = soup.weld();
  EXPECT_TRUE(geodesic_between(mesh, {FaceId(0), {1, 0, 0}}, {FaceId(mesh.faces.size() - 1), {1, 0, 0}})
                  .points.empty());
}

TEST(GeodesicFrom, IsStraightOnAPlaneAndEndsAtItsBoundary) {
  const SurfaceMesh mesh = shapes::plane(30, 30, 3, 3, 0.3).weld();
  const SurfacePoint from = shapes::nearest(mesh, {1.51, 1.47, 0});
  const Vec3 start = position_of(mesh, from), direction = Vec3(0.8, 0.6, 0);
  const SurfaceLine line = geodesic_from(mesh, from, direction + Vec3(0, 0, 3), 1);
  EXPECT_LT((line.points.back() - (start + direction)).norm(), 1e-9);
  expect_on_surface(mesh, line);
  const SurfaceLine cut = geodesic_from(mesh, from, direction, 100);
  EXPECT_NEAR(cut.points.back().x(), 3, 1e-9);
  EXPECT_NEAR(cut.length(), (3 - start.x()) / 0.8, 1e-9);
}

TEST(GeodesicFrom, GoesRoundACylinderOnce) {
  constexpr int sides = 40;
  const SurfaceMesh mesh = shapes::cylinder(sides, 30, 1, 4).weld();
  const SurfacePoint from = shapes::nearest(mesh, {1, 0.03, 2.02});
  const SurfaceLine helix = geodesic_from(mesh, from, {0, 1, 0.2}, 2);
  EXPECT_NEAR(helix.length(), 2, 1e-9);
  const Vec3 end = helix.points.back(), start = position_of(mesh, from);
  EXPECT_NEAR((end.z() - start.z()) / (around(end, sides, 1) - around(start, sides, 1)),
              0.2 / Vec3(0, 1, 0).dot(
                        Vec3(-std::sin(std::numbers::pi / sides), std::cos(std::numbers::pi / sides), 0)),
              1e-6);
  const SurfaceLine circle = geodesic_from(mesh, from, {0, 1, 0}, 100);
  EXPECT_NEAR(circle.length(), 2 * sides * std::sin(std::numbers::pi / sides), 0.2);
}

}  // namespace
}  // namespace applique
