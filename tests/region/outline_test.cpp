#include "applique/region/outline.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "applique/region/region.h"

namespace applique {
namespace {

const std::filesystem::path data = APPLIQUE_TEST_DATA;

Image blank(int width, int height) {
  return make_image(width, height, {0, 0, 0, 0});
}

Image drawing(const std::vector<std::string>& rows) {
  Image image = blank(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.pixel(x, y)[3] = rows[y][x] == '#' ? 0xffff : 0;
  }
  return image;
}

double distance_to(const std::vector<Pixel>& curve, Pixel p) {
  double best = 1e300;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Pixel a = curve[i], b = curve[i + 1 < curve.size() ? i + 1 : 0];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    best = std::min(best, std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy));
  }
  return best;
}

/// What the outline promises; an empty string when it holds.
std::string broken_promise(const Image& image, double threshold, bool check_distances = true) {
  const auto outline = alpha_outline(image, threshold);
  if (!outline) return outline.error().message;
  const ImageFrame frame = {static_cast<double>(image.width), static_cast<double>(image.height)};
  for (const auto& curve : {*outline, *trace_alpha(image, threshold)}) {
    const auto region = Region::from_contour(curve, frame);
    if (!region) return region.error().message;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        if (image.pixel(x, y)[3] <= 65535 * threshold) continue;
        for (const auto& [dx, dy] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.5}}) {
          // Vertices lie on multiples of a quarter; pulled in by less than a 16-bit image could show, corners
          // on slanted edges are inside in spite of the plane's rounding.
          const Pixel p = {x + dx + 1e-9 * (0.5 - dx), y + dy + 1e-9 * (0.5 - dy)};
          if (!region->contains(frame.to_plane(p)))
            return "pixel " + std::to_string(x) + " " + std::to_string(y) + " is cut";
        }
      }
    }
    for (const Pixel p : curve) {
      if (p.x < 0 || p.y < 0 || p.x > image.width || p.y > image.height) return "reaches out of the image";
    }
  }
  if (!check_distances) return "";
  const auto traced = *trace_alpha(image, threshold);
  if (outline->size() > traced.size()) return "not simplified";
  for (std::size_t i = 0; i < outline->size(); ++i) {
    const Pixel a = (*outline)[i], b = (*outline)[(i + 1) % outline->size()];
    const int steps = 1 + static_cast<int>(4 * std::hypot(b.x - a.x, b.y - a.y));
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      if (distance_to(traced, {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}) > 0.75 + 1e-9)
        return "too far from the trace";
    }
  }
  for (const Pixel p : traced) {
    if (distance_to(*outline, p) > 0.75 + 1e-9) return "the trace is too far";
  }
  return "";
}

TEST(Outline, OfARectangleIsItsCorners) {
  Image image = blank(40, 30);
  EXPECT_EQ(rectangle_outline(image).size(), 4U);
  for (int y = 5; y < 20; ++y) {
    for (int x = 3; x < 33; ++x) image.pixel(x, y)[3] = 0xffff;
  }
  const auto outline = *alpha_outline(image, 0.5);
  ASSERT_EQ(outline.size(), 4U);
  EXPECT_EQ(std::pair(outline[0].x, outline[0].y), std::pair(3.0, 5.0));
  EXPECT_EQ(std::pair(outline[2].x, outline[2].y), std::pair(33.0, 20.0));
}

TEST(Outline, NothingOpaqueIsAnError) {
  const auto outline = alpha_outline(make_image(10, 10, {0, 0, 0, 0x7fff}), 0.5);
  ASSERT_FALSE(outline);
  EXPECT_EQ(outline.error().code, ErrorCode::region_empty);
  EXPECT_NE(outline.error().message.find("0.5"), std::string::npos);
  EXPECT_TRUE(alpha_outline(make_image(10, 10, {0, 0, 0, 0x8000}), 0.5));
  EXPECT_EQ(alpha_outline(make_image(10, 10, {0, 0, 0, 0xffff}), 0)->size(), 4U);
}

TEST(Outline, PixelsThatTouchAtCorners) {
  for (const auto& rows :
       std::vector<std::vector<std::string>>{{"#"},
                                             {"#.", ".#"},
                                             {".#", "#."},
                                             {"#.#", ".#.", "#.#"},
                                             {".#.", "#.#", ".#."},
                                             {"#.#.#.#", ".#.#.#.", "#.#.#.#"},
                                             {"#....", ".#...", "..#..", "...#.", "....#"},
                                             {"##..##", "##..##", "..##..", "..##..", "##..##", "##..##"}}) {
    EXPECT_EQ(broken_promise(drawing(rows), 0.5), "") << rows[0];
  }
}

TEST(Outline, HolesAndIslandsWithinThemAreIgnored) {
  const auto outline = *alpha_outline(drawing({"#######", "#.....#", "#..#..#", "#.....#", "#######"}), 0.5);
  EXPECT_EQ(outline.size(), 4U);
}

TEST(Outline, IslandsAreJoinedByTheShortestBridges) {
  Image image = blank(100, 20);
  for (const int left : {0, 40, 50, 90}) {
    for (int y = 5; y < 15; ++y) {
      for (int x = left; x < left + 8; ++x) image.pixel(x, y)[3] = 0xffff;
    }
  }
  EXPECT_EQ(broken_promise(image, 0.5), "");
  const auto region = Region::from_contour(*alpha_outline(image, 0.5), {100, 20});
  // Bridges of 32, 2 and 32 pixels.
  const double area = region->area() * 50 * 50;
  EXPECT_GT(area, 4 * 80 + 66 - 1e-6);
  EXPECT_LT(area, 4 * 80 + 66 * 2.5);
}

TEST(Outline, ThinSpiralsStaySimple) {
  for (const double gap : {2.0, 3.0, 5.0}) {
    Image image = blank(200, 200);
    for (double angle = 0; angle < 90; angle += 0.002) {
      const double r = gap * angle / (2 * std::numbers::pi);
      if (r > 95) break;
      image.pixel(static_cast<int>(100 + r * std::cos(angle)),
                  static_cast<int>(100 + r * std::sin(angle)))[3] = 0xffff;
    }
    EXPECT_EQ(broken_promise(image, 0.5, false), "") << gap;
  }
}

TEST(Outline, SlantedEdgesTakeFewVertices) {
  Image image = blank(300, 300);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      if (std::abs(x - 150) + std::abs(y - 150) < 130) image.pixel(x, y)[3] = 0xffff;
    }
  }
  EXPECT_GT(trace_alpha(image, 0.5)->size(), 1000U);
  EXPECT_LE(alpha_outline(image, 0.5)->size(), 8U);
  EXPECT_EQ(broken_promise(image, 0.5), "");
}

RC_GTEST_PROP(Outline, RandomMasks, ()) {
  const int width = *rc::gen::inRange(1, 40), height = *rc::gen::inRange(1, 40);
  const double density = *rc::gen::inRange(1, 100) / 100.0;
  const int smoothing = *rc::gen::inRange(0, 4);
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> noise(static_cast<std::size_t>(width) * height);
  for (double& value : noise) value = uniform(random);
  Image image = blank(width, height);
  bool any = false;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {  // A box mean makes blobs of the noise.
      double sum = 0, count = 0;
      for (int v = std::max(0, y - smoothing); v <= std::min(height - 1, y + smoothing); ++v) {
        for (int u = std::max(0, x - smoothing); u <= std::min(width - 1, x + smoothing); ++u) {
          sum += noise[v * width + u];
          ++count;
        }
      }
      const bool opaque = sum / count < 0.5 + (density - 0.5) / (1 + smoothing);
      image.pixel(x, y)[3] = opaque ? 0xffff : 0;
      any |= opaque;
    }
  }
  RC_PRE(any);
  RC_ASSERT(broken_promise(image, 0.5) == "");
}

TEST(Outline, ImagesOfTheCollection) {
  if (data.empty()) GTEST_SKIP() << "needs the third-party images: set APPLIQUE_TEST_DATA";
  int seen = 0;
  for (const char* folder : {"images/openclipart", "images/noto", "images/mediapipe", "derived/images"}) {
    for (const auto& entry : std::filesystem::directory_iterator(data / folder)) {
      if (entry.path().extension() != ".png") continue;
      const auto image = read_image(entry.path());
      ASSERT_TRUE(image) << image.error().message;
      if (!image->has_alpha()) continue;
      ++seen;
      EXPECT_EQ(broken_promise(*image, 0.5, image->width < 200), "") << entry.path();
    }
  }
  EXPECT_GT(seen, 30);
}

}  // namespace
}  // namespace applique
