#include "applique/image/decal_image.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "applique/image/coverage.h"
#include "applique/region/region.h"

namespace applique {
namespace {

std::vector<Pixel> disc(double x, double y, double radius, int vertices) {
  std::vector<Pixel> polygon;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2 * std::numbers::pi * i / vertices;
    polygon.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
  return polygon;
}

double area_of(const std::vector<Pixel>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Pixel a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

Region region_of(const std::vector<Pixel>& contour, const Image& image) {
  return *Region::from_contour(contour,
                               {static_cast<double>(image.width), static_cast<double>(image.height)});
}

TEST(Coverage, IsTheExactAreaOfEachPixel) {
  const std::vector<Pixel> triangle = {{0.5, 0.25}, {3.5, 0.25}, {0.5, 3.25}};
  const auto coverage = polygon_coverage(triangle, 4, 0, 4);
  EXPECT_FLOAT_EQ(coverage[0], 0.375F);  // 0.5 wide, 0.75 high.
  EXPECT_FLOAT_EQ(coverage[1], 0.75F);
  EXPECT_FLOAT_EQ(coverage[2], 0.75F - 0.5F * 0.25F * 0.25F);  // The slope cuts the lower right corner.
  EXPECT_FLOAT_EQ(coverage[3], 0.125F);
  EXPECT_FLOAT_EQ(coverage[15], 0.0F);
  EXPECT_NEAR(std::accumulate(coverage.begin(), coverage.end(), 0.0), 4.5, 1e-6);
}

TEST(Coverage, SumsUpToTheAreaInBothOrientations) {
  for (const double shift : {0.0, 0.3, 0.77}) {
    auto polygon = disc(20 + shift, 25 - shift, 17.3, 37);
    for (int turn = 0; turn < 2; ++turn) {
      const auto coverage = polygon_coverage(polygon, 50, 0, 60);
      EXPECT_NEAR(std::accumulate(coverage.begin(), coverage.end(), 0.0), area_of(polygon), 1e-4);
      EXPECT_EQ(coverage[50 * 25 + 20], 1.0F);
      EXPECT_EQ(coverage[0], 0.0F);
      std::reverse(polygon.begin(), polygon.end());
    }
  }
}

TEST(Coverage, PolygonsMayReachBeyondTheImage) {
  const auto whole = polygon_coverage({{-5, -7}, {30, -7}, {30, 40}, {-5, 40}}, 16, 0, 9);
  for (const float value : whole) EXPECT_EQ(value, 1.0F);
  const auto polygon = disc(3, 5, 12.3, 41);
  const auto wide = polygon_coverage(disc(33, 35, 12.3, 41), 64, 0, 64);
  const auto cut = polygon_coverage(polygon, 8, 0, 11);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 8; ++x)
      EXPECT_NEAR(cut[8 * y + x], wide[64 * (y + 30) + x + 30], 1e-6) << x << ' ' << y;
  }
}

TEST(Coverage, BandsAreRowsOfTheWhole) {
  const auto polygon = disc(20, 25, 17.3, 37);
  const auto whole = polygon_coverage(polygon, 50, 0, 60), band = polygon_coverage(polygon, 50, 13, 40);
  for (std::size_t i = 0; i < band.size(); ++i) EXPECT_NEAR(band[i], whole[std::size_t{50} * 13 + i], 1e-6);
}

TEST(DecalImage, SrgbGoesBothWays) {
  EXPECT_EQ(srgb_to_linear(0), 0);
  EXPECT_DOUBLE_EQ(srgb_to_linear(1), 1);
  EXPECT_NEAR(srgb_to_linear(0.5), 0.214041, 1e-6);
  for (int i = 0; i <= 255; ++i) EXPECT_NEAR(linear_to_srgb(srgb_to_linear(i / 255.0)), i / 255.0, 1e-6);
}

TEST(DecalImage, IsLinearPremultipliedAndCut) {
  Image image = make_image(8, 8, {188 * 257, 255 * 257, 0, 128 * 257});
  const DecalImage decal = make_decal_image(image, region_of({{2, 2}, {6.5, 2}, {6.5, 6}, {2, 6}}, image));
  const double alpha = 128 / 255.0;
  const auto& inner = decal.texels[8 * 3 + 3];
  EXPECT_NEAR(inner[3], alpha, 1e-6);
  EXPECT_NEAR(inner[0], srgb_to_linear(188 / 255.0) * alpha, 1e-6);
  EXPECT_NEAR(inner[1], alpha, 1e-6);
  EXPECT_EQ(inner[2], 0);
  EXPECT_NEAR(decal.texels[8 * 3 + 6][3], 0.5 * alpha, 1e-6);  // Half covered.
  EXPECT_EQ(decal.texels[8 * 3 + 7][3], 0);
  EXPECT_EQ(decal.texels[8 * 3 + 1][1], 0);
}

TEST(DecalImage, LevelsAreMeansForAnySize) {
  for (const auto& [width, height] : {std::pair(1, 1), {1, 7}, {13, 5}, {16, 16}, {700, 333}}) {
    Image image = make_image(width, height, {0, 0, 0, 0xffff});
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        image.pixel(x, y)[1] = static_cast<std::uint16_t>((x * 7919 + y * 104729) % 65536);
    }
    const double w = width, h = height;
    const DecalImage decal = make_decal_image(image, region_of({{0, 0}, {w, 0}, {w, h}, {0, h}}, image));
    EXPECT_EQ(decal.levels.back().width, 1U);
    EXPECT_EQ(decal.levels.back().height, 1U);
    ASSERT_EQ(decal.texels.size(), decal.levels.back().offset + 1U);
    for (std::size_t k = 0; k < decal.levels.size(); ++k) {
      const auto& level = decal.levels[k];
      const int step = 1 << k;
      ASSERT_EQ(level.width, static_cast<std::uint32_t>((width + step - 1) / step));
      ASSERT_EQ(level.height, static_cast<std::uint32_t>((height + step - 1) / step));
      for (std::uint32_t i = 0; i < level.width * level.height; i += 1 + i / 7) {
        const int left = static_cast<int>(i % level.width) * step,
                  top = static_cast<int>(i / level.width) * step;
        double green = 0, alpha = 0;
        for (int y = top; y < std::min(height, top + step); ++y) {
          for (int x = left; x < std::min(width, left + step); ++x) {
            green += srgb_to_linear(image.pixel(x, y)[1] / 65535.0);
            alpha += 1;
          }
        }
        const double area = static_cast<double>(step) * step;
        ASSERT_NEAR(decal.texels[level.offset + i][1], green / area, 1e-5);
        ASSERT_NEAR(decal.texels[level.offset + i][3], alpha / area, 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace applique
