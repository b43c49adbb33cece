#include "applique/surface/surface_mesh.h"

#include <gtest/gtest.h>

#include "applique/surface/bridged_surface.h"
#include "applique/surface/shortest_path.h"

#include "support/shapes.h"

namespace applique {
namespace {

int euler(const SurfaceMesh& mesh) {
  std::size_t sides = 0, boundary = 0;
  for (const auto& n : mesh.neighbours)
    for (FaceId f : n) ++(f.valid() ? sides : boundary);
  return static_cast<int>(mesh.positions.size() + mesh.faces.size()) - static_cast<int>(sides / 2 + boundary);
}

std::size_t boundary_edges(const SurfaceMesh& mesh) {
  std::size_t count = 0;
  for (const auto& n : mesh.neighbours)
    for (FaceId f : n) count += !f.valid();
  return count;
}

TEST(Weld, ClosesTheSeamOfASphereAndATorus) {
  const SurfaceMesh sphere = shapes::sphere(3, 2).weld();
  EXPECT_EQ(euler(sphere), 2);
  EXPECT_EQ(boundary_edges(sphere), 0u);
  const SurfaceMesh torus = shapes::torus(24, 12, 2, 0.7).weld();
  EXPECT_EQ(euler(torus), 0);
  EXPECT_EQ(boundary_edges(torus), 0u);
  EXPECT_EQ(torus.cut_edges, 0u);
}

TEST(Weld, NeighboursAreMutualAndDegreesAdd) {
  const SurfaceMesh mesh = shapes::cylinder(16, 6, 1, 3).weld();
  std::size_t degrees = 0;
  for (FaceId f : ids<FaceId>(mesh.faces.size()))
    for (int k = 0; k < 3; ++k) {
      const FaceId g = mesh.neighbours[f][k];
      if (!g.valid()) continue;
      const int back = mesh.neighbour_edges[f][k];
      EXPECT_EQ(mesh.neighbours[g][back], f);
      EXPECT_EQ(mesh.faces[g][(back + 1) % 3], mesh.faces[f][(k + 2) % 3]);
    }
  for (std::uint32_t d : mesh.degree) degrees += d;
  EXPECT_EQ(degrees, 3 * mesh.faces.size());
  EXPECT_EQ(boundary_edges(mesh), 32u);
}

TEST(Weld, ToleratesTheRoundingOfFloats) {
  shapes::Soup soup = shapes::sphere(2, 1);
  // Unweld: each triangle with vertices of its own, rounded the one way or the other.
  shapes::Soup apart;
  for (const auto& t : soup.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.positions.size());
    for (std::uint32_t v : t)
      apart.positions.push_back(soup.positions[v] + Vec3(1e-8 * (first % 3), -1e-8 * (first % 2), 0));
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  const SurfaceMesh mesh = apart.weld();
  EXPECT_EQ(mesh.positions.size(), soup.positions.size());
  EXPECT_EQ(boundary_edges(mesh), 0u);
}

TEST(Weld, CutsNonManifoldEdgesAndSplitsVertices) {
  // Three faces on one edge.
  const SurfaceMesh fan = shapes::Soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                                       {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}}
                              .weld();
  EXPECT_EQ(fan.cut_edges, 1u);
  // Two triangles that touch in one point.
  const SurfaceMesh bow =
      shapes::Soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}}.weld();
  EXPECT_EQ(bow.split_vertices, 1u);
  EXPECT_EQ(bow.positions.size(), 6u);
  EXPECT_NE(bow.component[bow.faces[FaceId(0)][0]], bow.component[bow.faces[FaceId(1)][0]]);
}

TEST(Weld, KeepsBothSidesOfADoubleSheetApart) {
  // A plane and its back side, as exporters write for two-sided parts: the file's own connectivity decides.
  const shapes::Soup front = shapes::plane(4, 4, 1, 1);
  shapes::Soup both = front;
  const auto offset = static_cast<std::uint32_t>(front.positions.size());
  both.positions.insert(both.positions.end(), front.positions.begin(), front.positions.end());
  for (const auto& t : front.triangles)
    both.triangles.push_back({t[0] + offset, t[2] + offset, t[1] + offset});
  const SurfaceMesh mesh = both.weld();
  std::size_t joined = 0;
  for (FaceId f : ids<FaceId>(front.triangles.size()))
    for (FaceId g : mesh.neighbours[f])
      if (g.valid() && g.value < front.triangles.size()) ++joined;
  EXPECT_EQ(joined, 2u * (3 * 32 - 16) / 2);
}

TEST(Weld, DropsDegenerateTriangles) {
  const SurfaceMesh mesh =
      shapes::Soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}}, {{0, 1, 2}, {1, 3, 2}}}.weld();
  EXPECT_EQ(mesh.dropped_triangles, 1u);
  EXPECT_EQ(mesh.faces.size(), 1u);
  EXPECT_EQ(mesh.source[FaceId(0)], 0u);
}

TEST(BridgedSurface, ClosesAHoleWithAFan) {
  shapes::Soup soup = shapes::plane(6, 6, 6, 6);
  std::erase_if(soup.triangles, [&](const auto& t) {
    const Vec3 centre = (soup.positions[t[0]] + soup.positions[t[1]] + soup.positions[t[2]]) / 3;
    return (centre - Vec3(3, 3, 0)).cwiseAbs().maxCoeff() < 1;
  });
  const SurfaceMesh mesh = soup.weld();
  BridgedSurface bridged(mesh);
  bool found = false;
  for (FaceId f : ids<FaceId>(mesh.faces.size()))
    for (int k = 0; k < 3; ++k) {
      if (bridged.neighbour(f, k).valid()) continue;
      const auto hole = bridged.hole_at(f, k, 12);
      if (!hole) continue;  // the outer boundary
      EXPECT_EQ(hole->sides.size(), 8u);
      EXPECT_DOUBLE_EQ(hole->perimeter, 8);
      found = true;
      bridged.bridge(*hole);
      const FaceId across = bridged.neighbour(f, k);
      ASSERT_TRUE(bridged.is_bridge(across));
      EXPECT_EQ(bridged.neighbour(across, bridged.neighbour_edge(f, k)), f);
    }
  EXPECT_TRUE(found);
  EXPECT_EQ(bridged.bridged_holes(), 1u);
  const FaceId bridge(mesh.faces.size());
  EXPECT_EQ(bridged.degree(bridged.vertices(bridge)[0]), 8u);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(bridged.neighbour(bridge, k).valid());
}

TEST(ShortestPath, IsStraightOnAGridAndEmptyBetweenComponents) {
  const SurfaceMesh mesh = shapes::plane(20, 20, 1, 1).weld();
  const auto path =
      shortest_path(mesh, shapes::nearest(mesh, {0.1, 0.5, 0}), shapes::nearest(mesh, {0.9, 0.5, 0}));
  ASSERT_GE(path.size(), 2u);
  double length = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    length += (mesh.positions[path[i + 1]] - mesh.positions[path[i]]).norm();
  EXPECT_NEAR(length, 0.8, 0.06);
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    EXPECT_LT((mesh.positions[path[i + 1]] - mesh.positions[path[i]]).norm(), 0.08);

  shapes::Soup two = shapes::plane(2, 2, 1, 1);
  const shapes::Soup other = shapes::plane(2, 2, 1, 1);
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 9, t[1] + 9, t[2] + 9});
  for (const Vec3& p : other.positions) two.positions.push_back(p + Vec3(5, 0, 0));
  const SurfaceMesh apart = two.weld();
  EXPECT_TRUE(shortest_path(apart, {FaceId(0)}, {FaceId(8)}).empty());
}

}  // namespace
}  // namespace applique
