#include "applique/decal.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace applique {
namespace {

constexpr ImageFrame frame{512, 512};

Region rectangle() {
  return *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, frame);
}

/// A star with five points, concave.
Region star() {
  std::vector<Pixel> contour;
  for (int k = 0; k < 10; ++k) {
    const double r = k % 2 == 0 ? 250 : 110, angle = std::numbers::pi * (0.2 * k - 0.5);
    contour.push_back({256 + r * std::cos(angle), 256 + r * std::sin(angle)});
  }
  return *Region::from_contour(contour, frame);
}

struct Pin {
  Pixel image;
  Vec3 position;
};

DecalInput decal(const SurfaceMesh& surface, Region region, const std::vector<Pin>& pins) {
  DecalInput input{"test", std::move(region), {}, {}};
  for (const Pin& pin : pins) input.features.push_back({pin.image, shapes::nearest(surface, pin.position)});
  return input;
}

/// The largest distance, in pixels, of the map at the patch's vertices from `expected(surface point)`.
template <class Expected>
double map_error(const SurfaceMesh& surface, const DecalMap& map, Expected expected) {
  double worst = 0;
  for (PatchVertexId v : ids<PatchVertexId>(map.patch.vertices.size())) {
    if (!map.patch.vertices[v].valid()) continue;
    worst = std::max(worst, std::abs(map.image[v] - expected(surface.positions[map.patch.vertices[v]])));
  }
  return worst * frame.pixels_per_unit();
}

void expect_good(const DecalMap& map) {
  EXPECT_EQ(map.status, Coverage::covered);
  EXPECT_EQ(map.quality.flipped_plane, 0u);
  EXPECT_EQ(map.quality.flipped_image, 0u);
  EXPECT_GT(map.quality.coverage, 0.9999);
  for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 1e-8);
}

TEST(Decal, OnAPlaneIsTheExactSimilarity) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.3).weld();
  for (const Region& region : {rectangle(), star()}) {
    // One scene unit is 256 px; turned by 30 degrees about the middle.
    const Vec2 turn = std::polar(1.0, std::numbers::pi / 6);
    const auto image_of = [&](const Vec3& p) { return (Vec2(p.x() - 2, p.y() - 2)) * turn; };
    const auto place_of = [&](Pixel px) {
      const Vec2 z = frame.to_plane(px) / turn;
      return Vec3(z.real() + 2, z.imag() + 2, 0);
    };
    std::vector<Pin> pins;
    for (Pixel px : {Pixel{200, 220}, Pixel{320, 210}, Pixel{256, 330}, Pixel{250, 100}})
      pins.push_back({px, place_of(px)});
    for (std::size_t count : {2, 3, 4}) {
      const auto map = solve_decal(surface, decal(surface, region, {pins.begin(), pins.begin() + count}));
      ASSERT_TRUE(map.has_value()) << map.error().message;
      expect_good(*map);
      EXPECT_LT(map_error(surface, *map, image_of), 1e-7);
      EXPECT_LT(map->quality.l2_stretch, 1 + 1e-9);
    }
  }
}

TEST(Decal, WithOneFeatureTakesItsSizeAndDirection) {
  const SurfaceMesh surface = shapes::plane(30, 30, 4, 4, 0.2).weld();
  DecalInput input = decal(surface, rectangle(), {{{256, 256}, {2, 2, 0}}});
  input.lone = LoneFrame{2, {1, 0, 0.3}};  // up along +x: the image's right is -y
  const auto map = solve_decal(surface, input);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  expect_good(*map);
  EXPECT_LT(map_error(surface, *map, [](const Vec3& p) { return Vec2(-(p.y() - 2), p.x() - 2); }), 1e-7);
}

TEST(Decal, UnrollsACylinder) {
  const double radius = 1;
  const SurfaceMesh surface = shapes::cylinder(96, 40, radius, 4).weld();
  const auto on = [&](double angle, double z) {
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  // The label's middle is at angle 180 degrees, on the mesh's own seam of parameters.
  std::vector<Pin> pins;
  for (const auto& [x, y] :
       std::vector<std::pair<double, double>>{{100, 150}, {400, 150}, {400, 350}, {100, 350}, {256, 256}})
    pins.push_back({{x, y}, on(std::numbers::pi + (x - 256) / 200, 2 - (y - 256) / 200)});
  const auto map = solve_decal(surface, decal(surface, rectangle(), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_EQ(map->quality.flipped_image, 0u);
  EXPECT_LT(map->quality.l2_stretch, 1.001);
  EXPECT_GT(map->quality.coverage, 0.9999);
}

TEST(Decal, RandomSimilaritiesOfTheFeaturesGiveRandomSimilaritiesOfTheMap) {
  const SurfaceMesh surface = shapes::plane(48, 48, 6, 6, 0.3).weld();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int run = 0; run < 12; ++run) {
    const Vec2 scale = std::polar(0.5 + unit(random), 6.28 * unit(random));
    const Vec2 shift(0.4 * unit(random), 0.4 * unit(random));
    const auto image_of = [&](const Vec3& p) { return scale * Vec2(p.x() - 3, p.y() - 3) + shift; };
    std::vector<Pin> pins;
    for (Pixel px : {Pixel{200, 220}, Pixel{310, 230}, Pixel{256, 330}}) {
      const Vec2 z = (frame.to_plane(px) - shift) / scale;
      pins.push_back({px, {z.real() + 3, z.imag() + 3, 0}});
    }
    const auto map = solve_decal(surface, decal(surface, star(), pins));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    EXPECT_LT(map_error(surface, *map, image_of), 1e-6);
  }
}

/// A mask on a bump with features pulled away from where the isometry would have them.
std::vector<Pin> bent_pins() {
  return {{{130, 150}, {-0.42, 0.40, 0}},
          {{380, 150}, {0.45, 0.38, 0}},
          {{256, 256}, {0.02, 0.05, 0.6}},
          {{180, 400}, {-0.3, -0.45, 0}},
          {{340, 390}, {0.28, -0.5, 0}}};
}

TEST(Decal, FeaturesAreExactOnABump) {
  const SurfaceMesh surface = shapes::bump(64, 0.6, 0.35).weld();
  for (std::size_t count : {2, 3, 5}) {
    const auto pins = bent_pins();
    const auto map = solve_decal(surface, decal(surface, rectangle(), {pins.begin(), pins.begin() + count}));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    EXPECT_EQ(map->quality.flipped_image, 0u);
    for (double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
