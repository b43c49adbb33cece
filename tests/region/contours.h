#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "applique/region/region.h"

namespace applique {

/// The image of the contours below; whole pixels are exact in the plane.
inline constexpr ImageFrame contour_frame = {256, 256};

inline Vec2 plane(double x, double y) {
  return contour_frame.to_plane({x, y});
}

inline Region make_region(const std::vector<Pixel>& contour, const ImageFrame& frame = contour_frame) {
  auto region = Region::from_contour(contour, frame);
  EXPECT_TRUE(region) << region.error().message;
  return std::move(*region);
}

/// A simple polygon: radii between 20 and 120 px at ascending angles.
inline Region random_star(int vertices, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(20, 120);
  std::vector<Pixel> contour;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2 * std::numbers::pi * i / vertices, r = radius(random);
    contour.push_back({128 + r * std::cos(angle), 128 + r * std::sin(angle)});
  }
  return make_region(contour);
}

inline std::vector<Vec2> points_in(const Region& region, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-1, 1);
  std::vector<Vec2> points;
  while (points.size() < count) {
    const Vec2 z(x(random), x(random));
    if (region.contains(z)) points.push_back(z);
  }
  return points;
}

/// A U whose arms see each other only round the base.
inline const std::vector<Pixel> horseshoe = {{0, 0},   {20, 0},  {20, 230},  {236, 230},
                                             {236, 0}, {256, 0}, {256, 256}, {0, 256}};

}  // namespace applique
