#include "applique/surface/divided_surface.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace applique {
namespace {

double area_of(const SurfaceMesh& mesh) {
  double area = 0;
  for (const FaceId f : ids<FaceId>(mesh.faces.size())) {
    const auto p = mesh.corners(f);
    area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
  }
  return area;
}

double smallest_angle(const SurfaceMesh& mesh) {
  double smallest = std::numbers::pi;
  for (const FaceId f : ids<FaceId>(mesh.faces.size())) {
    const auto p = mesh.corners(f);
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }
  return smallest;
}

double longest_edge(const SurfaceMesh& mesh, FaceId f) {
  const auto p = mesh.corners(f);
  return std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
}

/// What SurfaceMesh promises of itself.
void expect_consistent(const SurfaceMesh& mesh) {
  std::vector<std::uint32_t> degree(mesh.positions.size(), 0);
  for (const FaceId f : ids<FaceId>(mesh.faces.size()))
    for (int k = 0; k < 3; ++k) {
      ++degree[mesh.faces[f][k].value];
      const FaceId across = mesh.neighbours[f][k];
      if (!across.valid()) continue;
      const int j = mesh.neighbour_edges[f][k];
      ASSERT_EQ(mesh.neighbours[across][j], f);
      ASSERT_EQ(mesh.neighbour_edges[across][j], k);
      ASSERT_EQ(mesh.faces[f][(k + 1) % 3], mesh.faces[across][(j + 2) % 3]);
      ASSERT_EQ(mesh.faces[f][(k + 2) % 3], mesh.faces[across][(j + 1) % 3]);
    }
  EXPECT_EQ(degree, mesh.degree.raw());
  for (const VertexId v : ids<VertexId>(mesh.positions.size())) {
    const auto& corners = mesh.faces[mesh.vertex_face[v]];
    EXPECT_TRUE(corners[0] == v || corners[1] == v || corners[2] == v);
  }
  EXPECT_EQ(mesh.component.size(), mesh.positions.size());
  EXPECT_EQ(mesh.source.size(), mesh.faces.size());
}

std::vector<SurfaceMesh> surfaces() {
  return {shapes::cylinder(3, 1, 1, 6).weld(), shapes::sphere(1, 1).weld(),
          shapes::plane(3, 2, 4, 1, 0.3).weld(), shapes::torus(5, 4, 2, 0.5).weld(),
          shapes::sponge(1, 1).weld()};
}

TEST(DividedSurface, IsTheSameSurfaceInSmallerTriangles) {
  for (const SurfaceMesh& mesh : surfaces()) {
    const double length = 0.1;
    const DividedSurface divided =
        divide_surface(mesh, std::vector<SurfacePoint>{{FaceId(0), {}}}, {length, 100});
    expect_consistent(divided.mesh);
    EXPECT_NEAR(area_of(divided.mesh), area_of(mesh), 1e-12 * area_of(mesh));
    EXPECT_GE(smallest_angle(divided.mesh), 0.5 * smallest_angle(mesh) - 1e-9);
    for (const FaceId f : ids<FaceId>(divided.mesh.faces.size())) {
      EXPECT_LE(longest_edge(divided.mesh, f), length);
      EXPECT_EQ(divided.mesh.source[f], mesh.source[divided.whole[f]]);
      for (int k = 0; k < 3; ++k) {
        const SurfacePoint corner = {divided.whole[f], divided.corners[f][k]};
        EXPECT_LT((position_of(mesh, corner) - divided.mesh.corners(f)[k]).norm(), 1e-12);
      }
    }
  }
}

TEST(DividedSurface, TakesPointsToPartsAndBack) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const SurfaceMesh& mesh : surfaces()) {
    const DividedSurface divided =
        divide_surface(mesh, std::vector<SurfacePoint>{{FaceId(0), {}}}, {0.2, 100});
    for (int i = 0; i < 100; ++i) {
      const double u = unit(random), v = (1 - u) * unit(random);
      const SurfacePoint point = {FaceId(random() % mesh.faces.size()), {1 - u - v, u, v}};
      const SurfacePoint part = divided.to_part(point);
      EXPECT_LT((position_of(divided.mesh, part) - position_of(mesh, point)).norm(), 1e-12);
      for (const double weight : part.barycentric) EXPECT_GE(weight, 0);
      const SurfacePoint back = divided.to_whole(part);
      EXPECT_EQ(back.face, point.face);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(back.barycentric[k], point.barycentric[k], 1e-12);
    }
  }
}

TEST(DividedSurface, StaysAsItIsBeyondReach) {
  const SurfaceMesh mesh = shapes::plane(40, 1, 40, 1).weld();
  const SurfacePoint place = shapes::nearest(mesh, {0.5, 0.5, 0});
  const DividedSurface divided = divide_surface(mesh, std::vector<SurfacePoint>{place}, {0.1, 2});
  expect_consistent(divided.mesh);
  for (const FaceId f : ids<FaceId>(divided.mesh.faces.size())) {
    const auto p = divided.mesh.corners(f);
    const double nearest = std::min({p[0].x(), p[1].x(), p[2].x()});
    if (nearest < 1.5) {
      EXPECT_LE(longest_edge(divided.mesh, f), 0.1);
    }
    if (nearest > 6) {
      EXPECT_EQ(divided.corners[f], whole_face);
    }
  }
  // The longest go first: where parts run out, they are about as long as one another.
  const DividedSurface rough = divide_surface(mesh, std::vector<SurfacePoint>{place}, {1e-6, 2, 500});
  EXPECT_LE(rough.mesh.faces.size(), mesh.faces.size() + 510);
  double longest = 0, shortest = 1e9;
  for (const FaceId f : ids<FaceId>(rough.mesh.faces.size())) {
    const auto p = rough.mesh.corners(f);
    if (std::max({p[0].x(), p[1].x(), p[2].x()}) > 1.5) continue;
    longest = std::max(longest, longest_edge(rough.mesh, f));
    shortest = std::min(shortest, longest_edge(rough.mesh, f));
  }
  EXPECT_LT(longest, 3 * shortest);
}

}  // namespace
}  // namespace applique
