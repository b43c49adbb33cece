#include "applique/image/draw.h"

#include <gtest/gtest.h>

namespace applique::draw {
namespace {

TEST(Canvas, CoversExactlyTheAreaOfAShape) {
  Canvas canvas(64, 64);
  canvas.fill(circle({32.3, 31.7}, 20), solid({1, 1, 1, 1}));
  const Image image = canvas.image();
  double area = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) area += image.rgba[i] / 65535.0;
  EXPECT_NEAR(area, 3.14159265 * 400, 2.0);
}

TEST(Canvas, LeavesAHoleWhereOutlinesNest) {
  Canvas canvas(64, 64);
  const Outline both[] = {circle({32, 32}, 20), circle({32, 32}, 10)};
  canvas.fill(both, solid({1, 0, 0, 1}));
  const Image image = canvas.image();
  EXPECT_EQ(image.pixel(32, 32)[3], 0);
  EXPECT_EQ(image.pixel(32, 17)[3], 65535);
}

}  // namespace
}  // namespace applique::draw
