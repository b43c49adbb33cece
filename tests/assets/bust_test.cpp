#include "bust.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "models.h"

namespace applique::assets {
namespace {

using Side = std::pair<std::uint32_t, std::uint32_t>;

/// Both are made once: they take seconds.
const Mesh& bust_mesh() {
  static const Mesh mesh = make_bust_mesh();
  return mesh;
}
constexpr int texture_size = 512;
const Model& bust() {
  static const Model model = make_bust(texture_size).value();
  return model;
}
const Model& bottle() {
  static const Model model = make_bottle(texture_size).value();
  return model;
}

TEST(Bust, IsAClosedOrientedManifoldInOnePiece) {
  const Mesh& mesh = bust_mesh();
  std::set<Side> sides;
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      ASSERT_TRUE(sides.insert({t[i], t[(i + 1) % 3]}).second)
          << "two triangles run along one side the same way";
  for (const auto& [a, b] : sides) ASSERT_TRUE(sides.contains({b, a})) << "a side without a neighbour";

  // One fan of triangles around each vertex.
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) next[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
  for (const auto& fan : next) {
    ASSERT_FALSE(fan.empty());
    std::size_t steps = 0;
    std::uint32_t v = fan.begin()->first;
    do {
      v = fan.at(v);
      ++steps;
    } while (v != fan.begin()->first && steps <= fan.size());
    ASSERT_EQ(steps, fan.size());
  }

  // A sphere in one piece: V - E + F = 2, and all is reached from one vertex.
  const auto euler = static_cast<std::ptrdiff_t>(mesh.positions.size() + mesh.triangles.size()) -
                     static_cast<std::ptrdiff_t>(sides.size() / 2);
  EXPECT_EQ(euler, 2);
  std::vector<bool> reached(mesh.positions.size(), false);
  std::vector<std::uint32_t> stack{0};
  reached[0] = true;
  std::size_t count = 1;
  while (!stack.empty()) {
    const auto& fan = next[stack.back()];
    stack.pop_back();
    for (const auto& [a, b] : fan)
      if (!reached[a]) {
        reached[a] = true;
        ++count;
        stack.push_back(a);
      }
  }
  EXPECT_EQ(count, mesh.positions.size());
}

TEST(Bust, HasWellShapedTrianglesOnTheSurfaceFacingOut) {
  const Mesh& mesh = bust_mesh();
  EXPECT_GE(mesh.triangles.size(), 25000U);
  EXPECT_LE(mesh.triangles.size(), 40000U);
  for (const Vec3& p : mesh.positions) ASSERT_LT(std::abs(bust_distance(p)), 1e-5);
  double volume = 0;
  std::size_t thin = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]];
    const Vec3 b = mesh.positions[t[1]];
    const Vec3 c = mesh.positions[t[2]];
    volume += a.dot(b.cross(c)) / 6;
    // 1 for an equilateral triangle.
    const double quality = 2 * std::sqrt(3.0) * (b - a).cross(c - a).norm() /
                           ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm());
    if (quality < 0.3) ++thin;
  }
  EXPECT_GT(volume, 0);
  EXPECT_LT(static_cast<double>(thin), 0.005 * static_cast<double>(mesh.triangles.size()));
}

TEST(Bust, HasItsLandmarksOnTheSurfaceInAnatomicalOrder) {
  std::map<std::string, Vec3> at;
  for (const Landmark& landmark : bust_landmarks()) {
    EXPECT_LT(std::abs(bust_distance(landmark.position)), 1e-6) << landmark.name;
    EXPECT_TRUE(at.emplace(landmark.name, landmark.position).second) << landmark.name << " is there twice";
  }
  EXPECT_GT(at.at("forehead").y(), at.at("nose_root").y());
  EXPECT_GT(at.at("nose_root").y(), at.at("nose_tip").y());
  EXPECT_GT(at.at("nose_tip").y(), at.at("mouth_middle").y());
  EXPECT_GT(at.at("mouth_middle").y(), at.at("chin").y());
  EXPECT_GT(at.at("nose_tip").z(), at.at("nose_root").z() + 0.1);
  EXPECT_GT(at.at("left_eye_outer").x(), at.at("left_eye_inner").x());
  EXPECT_GT(at.at("left_eye_inner").x(), at.at("right_eye_inner").x());
  EXPECT_GT(at.at("left_mouth_corner").x(), at.at("right_mouth_corner").x());
}

/// No triangle flipped, none over another (no texel centre in two), all inside the texture, charts a gutter
/// apart; returns the covered share.
double check_atlas(const Mesh& mesh, int size, int gutter) {
  constexpr int chart_unknown = -1;
  // Charts: vertices connected through triangles (chart borders have their own vertices).
  std::vector<std::uint32_t> root(mesh.positions.size());
  for (std::uint32_t v = 0; v < root.size(); ++v) root[v] = v;
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    root[find(t[1])] = find(t[0]);
    root[find(t[2])] = find(t[0]);
  }
  std::vector<int> owner(static_cast<std::size_t>(size) * size, chart_unknown);
  std::vector<int> chart(owner.size(), chart_unknown);
  std::size_t covered = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    Eigen::Vector2d p[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = mesh.uvs[t[i]];
      EXPECT_GE(p[i].minCoeff(), 0.0);
      EXPECT_LE(p[i].maxCoeff(), 1.0);
      p[i] *= size;
    }
    const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return a.x() * b.y() - a.y() * b.x();
    };
    // v runs down: counter-clockwise on the surface is clockwise in (u, v).
    EXPECT_LT(cross(p[1] - p[0], p[2] - p[0]), 0) << "triangle " << f << " is flipped";
    const Eigen::Vector2d low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
    const Eigen::Vector2d high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
    for (int y = static_cast<int>(low.y()); y <= std::min(size - 1, static_cast<int>(high.y())); ++y)
      for (int x = static_cast<int>(low.x()); x <= std::min(size - 1, static_cast<int>(high.x())); ++x) {
        const Eigen::Vector2d c(x + 0.5, y + 0.5);
        if (cross(p[1] - p[0], c - p[0]) >= 0 || cross(p[2] - p[1], c - p[1]) >= 0 ||
            cross(p[0] - p[2], c - p[2]) >= 0)
          continue;
        const std::size_t i = static_cast<std::size_t>(y) * size + x;
        EXPECT_EQ(owner[i], chart_unknown) << "triangles " << f << " and " << owner[i] << " overlap";
        owner[i] = static_cast<int>(f);
        chart[i] = static_cast<int>(find(t[0]));
        ++covered;
      }
  }
  // Along rows and columns, texels of different charts are at least the gutter apart.
  for (const bool along_x : {true, false})
    for (int line = 0; line < size; ++line) {
      int last = -gutter - 1;
      int last_chart = chart_unknown;
      for (int i = 0; i < size; ++i) {
        const int c = along_x ? chart[static_cast<std::size_t>(line) * size + i]
                              : chart[static_cast<std::size_t>(i) * size + line];
        if (c == chart_unknown) continue;
        if (c != last_chart && last_chart != chart_unknown) {
          EXPECT_GT(i - last, gutter);
        }
        last = i;
        last_chart = c;
      }
    }
  return static_cast<double>(covered) / static_cast<double>(owner.size());
}

/// Square root of texture area over surface area, at the given share of the surface.
double density_at(const Mesh& mesh, double share) {
  std::vector<std::pair<double, double>> densities;
  double total = 0;
  for (const Triangle& t : mesh.triangles) {
    const Eigen::Vector2d ab = mesh.uvs[t[1]] - mesh.uvs[t[0]];
    const Eigen::Vector2d ac = mesh.uvs[t[2]] - mesh.uvs[t[0]];
    const double area = (mesh.positions[t[1]] - mesh.positions[t[0]])
                            .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
                            .norm();
    densities.emplace_back(std::sqrt(std::abs(ab.x() * ac.y() - ab.y() * ac.x()) / area), area);
    total += area;
  }
  std::sort(densities.begin(), densities.end());
  double sum = 0;
  for (const auto& [density, area] : densities)
    if ((sum += area) >= share * total) return density;
  return densities.back().first;
}

TEST(Bust, HasAnAtlasWithoutFlipsOrOverlaps) {
  // 2048 texels, as the demo has; the texture itself plays no part.
  EXPECT_GT(check_atlas(bust().mesh, 2048, 8), 0.45);
  EXPECT_LT(density_at(bust().mesh, 0.99) / density_at(bust().mesh, 0.01), 2.6);
}

TEST(Bust, HasATextureWithoutHoles) {
  const Image& image = bust().texture;
  ASSERT_EQ(image.width, texture_size);
  ASSERT_EQ(image.height, texture_size);
  // Marble everywhere, gutters too: never black, never white as where nothing was painted.
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      ASSERT_GT(image.pixel(x, y)[0], 0.3 * 65535);
      ASSERT_LT(image.pixel(x, y)[2], 0.95 * 65535);
    }
}

TEST(Bottle, HasAnAtlasWithoutFlipsOrOverlaps) {
  EXPECT_GT(check_atlas(bottle().mesh, 2048, 8), 0.4);
  EXPECT_GE(bottle().mesh.triangles.size(), 4000U);
  EXPECT_LE(bottle().mesh.triangles.size(), 6000U);
}

}  // namespace
}  // namespace applique::assets
