// The blend modes against the formulas of W3C Compositing and Blending Level 1, written out channel by
// channel, and normals against rotations.
#include "compositing.h"

#include <array>
#include <random>

#include <gtest/gtest.h>

#include "applique/transfer/transfer.h"

namespace applique {
namespace {

using Rgb = std::array<double, 3>;

double multiply(double b, double s) {
  return b * s;
}
double screen(double b, double s) {
  return 1 - (1 - b) * (1 - s);
}
double hard_light(double b, double s) {
  return s <= 0.5 ? multiply(b, 2 * s) : screen(b, 2 * s - 1);
}
double color_dodge(double b, double s) {
  return b == 0 ? 0 : s == 1 ? 1 : std::min(1.0, b / (1 - s));
}
double color_burn(double b, double s) {
  return b == 1 ? 1 : s == 0 ? 0 : 1 - std::min(1.0, (1 - b) / s);
}
double soft_light(double b, double s) {
  const double d = b <= 0.25 ? ((16 * b - 12) * b + 4) * b : std::sqrt(b);
  return s <= 0.5 ? b - (1 - 2 * s) * b * (1 - b) : b + (2 * s - 1) * (d - b);
}

double lum(const Rgb& c) {
  return 0.3 * c[0] + 0.59 * c[1] + 0.11 * c[2];
}
double sat(const Rgb& c) {
  return *std::max_element(c.begin(), c.end()) - *std::min_element(c.begin(), c.end());
}
Rgb clip_color(Rgb c) {
  const double l = lum(c), n = *std::min_element(c.begin(), c.end()),
               x = *std::max_element(c.begin(), c.end());
  for (double& v : c) {
    if (n < 0) v = l + (v - l) * l / (l - n);
  }
  for (double& v : c) {
    if (x > 1) v = l + (v - l) * (1 - l) / (x - l);
  }
  return c;
}
Rgb set_lum(Rgb c, double l) {
  const double d = l - lum(c);
  for (double& v : c) v += d;
  return clip_color(c);
}
/// As the specification has it: by the order of the three channels.
Rgb set_sat(Rgb c, double s) {
  std::array<int, 3> order = {0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return c[a] < c[b]; });
  const auto [low, middle, high] = order;
  if (c[high] > c[low]) {
    c[middle] = (c[middle] - c[low]) * s / (c[high] - c[low]);
    c[high] = s;
  } else {
    c[middle] = c[high] = 0;
  }
  c[low] = 0;
  return c;
}

Rgb reference(BlendMode mode, const Rgb& b, const Rgb& s) {
  switch (mode) {
    case BlendMode::hue:
      return set_lum(set_sat(s, sat(b)), lum(b));
    case BlendMode::saturation:
      return set_lum(set_sat(b, sat(s)), lum(b));
    case BlendMode::color:
      return set_lum(s, lum(b));
    case BlendMode::luminosity:
      return set_lum(b, lum(s));
    default:
      break;
  }
  Rgb result{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double below = b[c], source = s[c];
    switch (mode) {
      case BlendMode::multiply:
        result[c] = multiply(below, source);
        break;
      case BlendMode::screen:
        result[c] = screen(below, source);
        break;
      case BlendMode::overlay:
        result[c] = hard_light(source, below);
        break;
      case BlendMode::darken:
        result[c] = std::min(below, source);
        break;
      case BlendMode::lighten:
        result[c] = std::max(below, source);
        break;
      case BlendMode::color_dodge:
        result[c] = color_dodge(below, source);
        break;
      case BlendMode::color_burn:
        result[c] = color_burn(below, source);
        break;
      case BlendMode::hard_light:
        result[c] = hard_light(below, source);
        break;
      case BlendMode::soft_light:
        result[c] = soft_light(below, source);
        break;
      case BlendMode::difference:
        result[c] = std::abs(below - source);
        break;
      case BlendMode::exclusion:
        result[c] = below + source - 2 * below * source;
        break;
      case BlendMode::add:
        result[c] = std::min(1.0, below + source);
        break;
      default:
        result[c] = source;
    }
  }
  return result;
}

/// Mostly anything, now and then 0, 1, or grey: where the formulas have their cases.
Rgb random_colour(std::mt19937& random) {
  std::uniform_real_distribution<double> any(0, 1);
  Rgb c = {any(random), any(random), any(random)};
  for (double& v : c) {
    if (random() % 8 == 0) v = static_cast<double>(random() % 3) / 2;
  }
  if (random() % 8 == 0) c[1] = c[2] = c[0];
  return c;
}

TEST(Compositing, IsThatOfTheSpecification) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(0.01, 1);
  for (unsigned m = 0; m < static_cast<unsigned>(BlendMode::erase); ++m) {
    for (int i = 0; i < 2000; ++i) {
      const Rgb b = random_colour(random), s = random_colour(random);
      const double alpha = i % 4 == 0 ? 1 : any(random), backdrop = i % 3 == 0 ? 1 : any(random);
      const bool opaque = i % 5 == 0;
      const Rgb mixed = reference(static_cast<BlendMode>(m), b, s);
      const double ab = opaque ? 1 : backdrop;
      const auto result = compositing::composite(m, {s[0] * alpha, s[1] * alpha, s[2] * alpha, alpha},
                                                 {b[0], b[1], b[2], backdrop}, opaque);
      for (int c = 0; c < 3; ++c) {
        const double premultiplied =
            (1 - ab) * alpha * s[c] + ab * alpha * mixed[c] + (1 - alpha) * ab * b[c];
        ASSERT_NEAR(result[c], premultiplied / (alpha + ab * (1 - alpha)), 1e-9)
            << "mode " << m << ", case " << i << ", channel " << c;
      }
      ASSERT_NEAR(result[3], alpha + backdrop * (1 - alpha), 1e-12);
    }
  }
}

TEST(Compositing, ErasesByAlphaAndKeepsTheColour) {
  const auto result =
      compositing::composite(compositing::blend_erase, {0.1, 0.1, 0.1, 0.25}, {0.2, 0.4, 0.6, 0.8}, false);
  EXPECT_EQ(result, compositing::vec4(0.2, 0.4, 0.6, 0.8 * 0.75));
}

compositing::vec4 stored(double x, double y, double z, double alpha) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {alpha * (0.5 + 0.5 * x / length), alpha * (0.5 + 0.5 * y / length),
          alpha * (0.5 + 0.5 * z / length), alpha};
}

TEST(Compositing, NormalsAreTurnedIntoTheTexturesFrame) {
  const auto flat = stored(0, 0, 1, 1);
  for (const bool reversed : {false, true}) {
    for (double angle = -3; angle < 3; angle += 0.37) {
      const double c = std::cos(angle), s = std::sin(angle), side = reversed ? -1 : 1;
      for (const std::uint32_t mode : {compositing::blend_normal, compositing::blend_add}) {
        const auto result =
            compositing::composite_normal(mode, stored(0.3, -0.5, 1, 1), flat, {c, s}, {-side * s, side * c});
        const auto expected = stored(0.3 * c + 0.5 * side * s, 0.3 * s - 0.5 * side * c, 1, 1);
        for (int k = 0; k < 4; ++k) EXPECT_NEAR(result[k], expected[k], 1e-12);
      }
    }
  }
}

TEST(Compositing, ReliefLiesOnTheReliefThatIsThere) {
  const compositing::vec2 x(1, 0), y(0, 1);
  const auto there = stored(0.4, 0.1, 1, 1);
  // A flat decal changes nothing; over a flat texture the decal is as it is; half of it half as steep, or so.
  const auto unchanged =
      compositing::composite_normal(compositing::blend_add, stored(0, 0, 1, 1), there, x, y);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(unchanged[k], there[k], 1e-12);
  const auto steeper =
      compositing::composite_normal(compositing::blend_add, stored(0.4, 0, 1, 1), there, x, y);
  EXPECT_GT(steeper[0], there[0]);
  // Two tilts about one axis add up.
  const double a = 0.3, b = 0.4;
  const auto sum =
      compositing::composite_normal(compositing::blend_add, stored(std::sin(a), 0, std::cos(a), 1),
                                    stored(std::sin(b), 0, std::cos(b), 1), x, y);
  EXPECT_NEAR(2 * sum[0] - 1, std::sin(a + b), 1e-12);
}

}  // namespace
}  // namespace applique
