#include "applique/rivals/stroke_axis.h"

#include <gtest/gtest.h>

namespace applique {
namespace {

using Order = std::vector<std::size_t>;

TEST(StrokeAxis, OfALoneFeatureRunsAlongTheImage) {
  const StrokeAxis axis = find_stroke_axis({{0.2, 0.3}}, 0, 0.1);
  EXPECT_EQ(axis.features, Order{0});
  EXPECT_EQ(axis.direction, Vec2(1));
  EXPECT_EQ(axis.places, std::vector<double>{0});
}

TEST(StrokeAxis, TakesTheFeaturesOnTheLineInOrder) {
  const Vec2 origin(0.1, -0.2), way = std::polar(1.0, 0.7), side(0, 1);
  const std::vector<Vec2> features = {origin + 0.5 * way, origin - 0.4 * way, origin,
                                      origin + 0.8 * way + 0.4 * way * side,  // off the line
                                      origin - 0.1 * way};
  const StrokeAxis axis = find_stroke_axis(features, 2, 0.05);
  const bool forth = dot(axis.direction, way) > 0;
  EXPECT_NEAR(std::abs(cross(axis.direction, way)), 0, 1e-12);
  EXPECT_EQ(axis.features, forth ? Order({1, 4, 2, 0}) : Order({0, 2, 4, 1}));
  for (std::size_t i = 1; i < axis.places.size(); ++i) EXPECT_GT(axis.places[i], axis.places[i - 1]);
  for (std::size_t i = 0; i < axis.places.size(); ++i)
    EXPECT_NEAR(axis.places[i], axis.along(features[axis.features[i]]), 1e-12);
}

TEST(StrokeAxis, FitsFeaturesBesideTheLine) {
  const StrokeAxis axis = find_stroke_axis({{0, 0}, {0.5, 0.02}, {-0.5, 0.02}}, 0, 0.05);
  EXPECT_NEAR(std::abs(axis.direction.real()), 1, 1e-12) << "the two pull it neither way";
  EXPECT_EQ(axis.features.size(), 3u);
}

TEST(StrokeAxis, PassesByWhatLiesBesideAnother) {
  const StrokeAxis axis = find_stroke_axis({{0, 0}, {0.5, 0}, {0.5, 0.03}, {0.9, 0}}, 0, 0.05);
  EXPECT_EQ(axis.features.size(), 3u);
  EXPECT_EQ(std::count(axis.features.begin(), axis.features.end(), 1u) +
                std::count(axis.features.begin(), axis.features.end(), 2u),
            1);
}

}  // namespace
}  // namespace applique
