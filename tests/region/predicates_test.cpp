#include "applique/base/predicates.h"

#include <cmath>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace applique {
namespace {

using Rational = boost::multiprecision::cpp_rational;

int rational_orientation(Vec2 a, Vec2 b, Vec2 c) {
  const Rational ax(a.real()), ay(a.imag()), bx(b.real()), by(b.imag()), cx(c.real()), cy(c.imag());
  return Rational((ax - cx) * (by - cy) - (ay - cy) * (bx - cx)).sign();
}

int rational_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  Rational x[3], y[3], lift[3];
  const Vec2 points[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    x[i] = Rational(points[i].real()) - Rational(d.real());
    y[i] = Rational(points[i].imag()) - Rational(d.imag());
    lift[i] = x[i] * x[i] + y[i] * y[i];
  }
  return Rational(lift[0] * (x[1] * y[2] - x[2] * y[1]) + lift[1] * (x[2] * y[0] - x[0] * y[2]) +
                  lift[2] * (x[0] * y[1] - x[1] * y[0]))
      .sign();
}

/// `value` moved by a few units in the last place.
double nudged(double value, int ulps) {
  for (; ulps > 0; --ulps) value = std::nextafter(value, 1e300);
  for (; ulps < 0; ++ulps) value = std::nextafter(value, -1e300);
  return value;
}

TEST(Predicates, OrientationIsExactNearALine) {
  // Points of a line with slope 1/3, moved by single ulps: plain floating point gets many of them wrong.
  int disagreements = 0;
  for (int i = -20; i <= 20; ++i) {
    for (int j = -20; j <= 20; ++j) {
      const Vec2 a(nudged(0.5, i), nudged(0.5, j)), b(12, 12), c(24, 24);
      EXPECT_EQ(orientation(a, b, c), rational_orientation(a, b, c)) << i << ' ' << j;
      const double plain =
          (b.real() - a.real()) * (c.imag() - a.imag()) - (b.imag() - a.imag()) * (c.real() - a.real());
      disagreements += ((plain > 0) - (plain < 0)) != orientation(a, b, c);
    }
  }
  EXPECT_GT(disagreements, 0);
}

RC_GTEST_PROP(Predicates, OrientationAgreesWithRationalNumbers, ()) {
  const auto coordinate = rc::gen::map(rc::gen::inRange(-1000000, 1000000), [](int n) { return n / 7.0; });
  const Vec2 a(*coordinate, *coordinate), b(*coordinate, *coordinate);
  const double t = *coordinate / 1e4;
  const Vec2 c = a + t * (b - a);
  const Vec2 d(nudged(c.real(), *rc::gen::inRange(-3, 4)), nudged(c.imag(), *rc::gen::inRange(-3, 4)));
  RC_ASSERT(orientation(a, b, d) == rational_orientation(a, b, d));
  RC_ASSERT(orientation(a, b, d) == orientation(b, d, a));
  RC_ASSERT(orientation(a, b, d) == -orientation(b, a, d));
}

TEST(Predicates, SurviveTinyAndHugeNumbers) {
  EXPECT_EQ(orientation({0, 0}, {1e-300, 0}, {0, 1e-300}), 1);
  EXPECT_EQ(orientation({0, 0}, {1e-300, 1e-300}, {2e-300, 2e-300}), 0);
  EXPECT_EQ(orientation({0, 0}, {1e150, 1e-300}, {1e150, 0}), -1);
  EXPECT_EQ(orientation({0, 0}, {0, 0}, {3, 4}), 0);
  EXPECT_EQ(in_circle({1e-100, 0}, {0, 1e-100}, {-1e-100, 0}, {0, 0}), 1);
  EXPECT_EQ(in_circle({1e-100, 0}, {0, 1e-100}, {-1e-100, 0}, {0, -1e-100}), 0);
}

TEST(Predicates, InCircleIsExactOnTheCircle) {
  EXPECT_EQ(in_circle({1, 0}, {0, 1}, {-1, 0}, {0, 0}), 1);
  EXPECT_EQ(in_circle({1, 0}, {0, 1}, {-1, 0}, {0, -1}), 0);
  EXPECT_EQ(in_circle({1, 0}, {0, 1}, {-1, 0}, {0, -2}), -1);
}

RC_GTEST_PROP(Predicates, InCircleAgreesWithRationalNumbers, ()) {
  const int which = *rc::gen::inRange(0, 8);
  const int x[] = {3, 4, 5, -3, -4, 0, 4, -5}, y[] = {4, 3, 0, 4, -3, 5, -3, 0};
  const Vec2 shift(*rc::gen::inRange(-1000, 1000), *rc::gen::inRange(-1000, 1000));
  const double scale = 1.0 / *rc::gen::inRange(1, 50);
  const auto point = [&](int i) { return scale * (shift + Vec2(x[i % 8], y[i % 8])); };
  const Vec2 a = point(0), b = point(5), c = point(4);
  const Vec2 d(nudged(point(which).real(), *rc::gen::inRange(-2, 3)), point(which).imag());
  RC_ASSERT(in_circle(a, b, c, d) == rational_in_circle(a, b, c, d));
  RC_ASSERT(in_circle(a, b, c, d) == in_circle(b, c, a, d));
  RC_ASSERT(in_circle(a, b, c, d) == -in_circle(b, a, c, d));
}

}  // namespace
}  // namespace applique
