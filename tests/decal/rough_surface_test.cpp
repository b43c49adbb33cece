#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "applique/decal.h"

#include "support/shapes.h"

namespace applique {
namespace {

constexpr double pi = std::numbers::pi;
constexpr ImageFrame frame{512, 512};

Region disc() {
  std::vector<Pixel> contour;
  for (int k = 0; k < 48; ++k)
    contour.push_back({256 + 240 * std::cos(2 * pi * k / 48), 256 + 240 * std::sin(2 * pi * k / 48)});
  return *Region::from_contour(contour, frame);
}

/// Three pins on a surface over the xy plane, each under its place in an image of two units' width.
DecalInput pinned(const SurfaceMesh& surface) {
  DecalInput input{"rough", disc(), {}, {}};
  for (const Pixel pixel : {Pixel{96, 256}, Pixel{416, 256}, Pixel{256, 416}}) {
    const Vec2 z = frame.to_plane(pixel);
    input.features.push_back({pixel, shapes::nearest(surface, {0.8 * z.real(), 0.8 * z.imag(), 0}), 0});
  }
  return input;
}

void expect_sound(const Result<DecalMap>& map) {
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->quality.flipped_plane, 0U);
  EXPECT_EQ(map->quality.flipped_image, 0U);
  EXPECT_GT(map->quality.coverage, 0.995);
  for (const double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
}

/// [-1.5, 1.5]^2 under a height.
SurfaceMesh terrain(int cells, const std::function<double(double, double)>& height) {
  return shapes::grid(cells, cells,
                      [&](double u, double v) {
                        const double x = 3 * u - 1.5, y = 3 * v - 1.5;
                        return Vec3(x, y, height(x, y));
                      })
      .weld();
}

/// Rows of triangles whose sides are as 1 to 10000.
TEST(RoughSurface, SliversAreNoObstacle) {
  constexpr int rows = 49;
  const SurfaceMesh surface =
      shapes::grid(48, rows, [&](double u, double v) {
        // Every other row is thinner than its cells are wide by four orders.
        const double row = std::round(v * rows), thin = 3.0 / 48 / 1e4;
        const double y = std::floor((row + 1) / 2) * thin + std::floor(row / 2) * (3.0 - 25 * thin) / 24;
        return Vec3(3 * u - 1.5, y - 1.5, 0);
      }).weld();
  double thinnest = 1;
  for (FaceId f : ids<FaceId>(surface.faces.size())) {
    const auto c = surface.corners(f);
    const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    thinnest = std::min(thinnest, (c[1] - c[0]).cross(c[2] - c[0]).norm() / longest / longest);
  }
  ASSERT_LT(thinnest, 1.1e-4);
  const auto map = solve_decal(surface, pinned(surface));
  expect_sound(map);
  EXPECT_LT(map->quality.l2_stretch, 1.0001);
}

TEST(RoughSurface, NoiseCreasesAndSpikesTurnNothingOver) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(-0.02, 0.02);
  expect_sound(solve_decal(terrain(60, [&](double, double) { return noise(random); }),
                           pinned(terrain(60, [](double, double) { return 0; }))));
  const SurfaceMesh creased = terrain(60, [](double x, double) { return 0.6 * std::abs(x - 0.1); });
  expect_sound(solve_decal(creased, pinned(creased)));
  const SurfaceMesh stairs = terrain(60, [](double x, double y) { return x + 0.3 * y > 0 ? 0.15 : 0.0; });
  expect_sound(solve_decal(stairs, pinned(stairs)));
  const SurfaceMesh spiked = terrain(
      60, [](double x, double y) { return 1.5 * std::exp(-((x - 0.2) * (x - 0.2) + y * y) / 0.005); });
  expect_sound(solve_decal(spiked, pinned(spiked)));
}

/// A narrow slit in the surface ends the decal there, and nothing else.
TEST(RoughSurface, ACrackIsGoneRound) {
  shapes::Soup soup =
      shapes::grid(60, 60, [](double u, double v) { return Vec3(3 * u - 1.5, 3 * v - 1.5, 0); });
  std::erase_if(soup.triangles, [&](const auto& t) {
    Vec3 middle = Vec3::Zero();
    for (const auto v : t) middle += soup.positions[v] / 3;
    return std::abs(middle.y() - 0.1) < 0.03 && std::abs(middle.x()) < 0.5;
  });
  const SurfaceMesh surface = soup.weld();
  const auto map = solve_decal(surface, pinned(surface));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->quality.flipped_plane + map->quality.flipped_image, 0U);
  EXPECT_LT(map->quality.l2_stretch, 1.001);
  EXPECT_GT(map->quality.coverage, 0.95);
}

/// A tower inside the image, on whose flat foot the image's size is fixed. Conformal maps pay for its walls
/// with areas that are off by more than four times.
TEST(RoughSurface, AreasStayWithinTwiceWhereThoseOfTheConformalMapDoNot) {
  for (const double height : {4.0, 5.0, 6.0}) {
    const SurfaceMesh surface = terrain(
        96, [&](double x, double y) { return height / (1 + std::exp(30 * (std::hypot(x, y) - 0.45))); });
    DecalInput input{"tower", disc(), {}, {}};
    input.features.push_back({{256, 480}, shapes::nearest(surface, {0, -0.9, 0}), 0});
    input.lone = LoneFrame{2, Vec3(0, 1, 0)};
    const double isometry = input.region.area() * std::pow(2 / (frame.width / frame.pixels_per_unit()), 2);
    SolveOptions options;
    options.energy = Energy::conformal;
    const auto conformal = solve_decal(surface, input, options);
    ASSERT_TRUE(conformal.has_value()) << conformal.error().message;
    ASSERT_LT(conformal->quality.area, isometry / 4) << "choose a harder case";
    const auto isometric = solve_decal(surface, input);
    expect_sound(isometric);
    EXPECT_GT(isometric->quality.area, isometry / 2);
    EXPECT_LT(isometric->quality.area, isometry * 2);
  }
}

}  // namespace
}  // namespace applique
