#include "applique/base/triangle_grid.h"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace applique {
namespace {

/// Whatever the triangles are like, none whose box meets that of the one asked about is missed.
TEST(TriangleGrid, FindsAllWhoseBoxesMeet) {
  using Triangle = TriangleGrid::Triangle;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Vec2 extent : {Vec2(1, 1), Vec2(1e6, 1e-6), Vec2(0, 1), Vec2(0, 0)}) {
    std::vector<Triangle> triangles;
    for (int i = 0; i < 200; ++i) {
      const double size = std::pow(10, 2 * unit(random) - 2);
      const Vec2 at(unit(random), unit(random));
      Triangle& t = triangles.emplace_back();
      for (Vec2& z : t) {
        const Vec2 corner = at + size * Vec2(unit(random), unit(random));
        z = {extent.real() * corner.real(), extent.imag() * corner.imag()};
      }
    }
    TriangleGrid grid(triangles);
    for (std::uint32_t i = 0; i < 100; ++i) grid.insert(i, triangles[i]);
    const auto overlap = [](const Triangle& a, const Triangle& b, const auto& along) {
      const auto [least_a, most_a] = std::minmax({along(a[0]), along(a[1]), along(a[2])});
      const auto [least_b, most_b] = std::minmax({along(b[0]), along(b[1]), along(b[2])});
      return most_a >= least_b && most_b >= least_a;
    };
    for (const Triangle& asked : triangles) {
      std::set<std::uint32_t> found;
      EXPECT_FALSE(grid.any_near(asked, [&](std::uint32_t id) {
        found.insert(id);
        return false;
      }));
      for (std::uint32_t i = 0; i < 100; ++i)
        if (overlap(asked, triangles[i], [](Vec2 z) { return z.real(); }) &&
            overlap(asked, triangles[i], [](Vec2 z) { return z.imag(); })) {
          EXPECT_TRUE(found.contains(i));
        }
      if (!found.empty()) {
        EXPECT_TRUE(grid.any_near(asked, [](std::uint32_t) { return true; }));
      }
    }
  }
}

}  // namespace
}  // namespace applique
