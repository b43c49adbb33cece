#include "applique/base/predicates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

namespace applique {
namespace {

using boost::multiprecision::cpp_int;

// Half an ulp of 1, and the filters' relative error bounds (Shewchuk 1997, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates": ccwerrboundA and iccerrboundA).
constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;
constexpr double orientation_bound = (3 + 16 * epsilon) * epsilon;
constexpr double in_circle_bound = (10 + 96 * epsilon) * epsilon;
// Below this a product may have lost bits to underflow, which the bounds do not cover.
constexpr double smallest_safe = 1e-250;

int sign(double value) {
  return (value > 0) - (value < 0);
}

/// The coordinates of N points as integers, all scaled by one power of two: signs of homogeneous polynomials
/// keep their value.
template <std::size_t N>
std::array<std::array<cpp_int, 2>, N> to_integers(const std::array<Vec2, N>& points) {
  int lowest = std::numeric_limits<int>::max();
  std::array<std::array<int, 2>, N> exponents{};
  std::array<std::array<std::int64_t, 2>, N> mantissas{};
  for (std::size_t i = 0; i < N; ++i) {
    const std::array<double, 2> xy = {points[i].real(), points[i].imag()};
    for (std::size_t k = 0; k < 2; ++k) {
      mantissas[i][k] = static_cast<std::int64_t>(std::ldexp(std::frexp(xy[k], &exponents[i][k]), 53));
      if (mantissas[i][k] != 0) lowest = std::min(lowest, exponents[i][k]);
    }
  }
  std::array<std::array<cpp_int, 2>, N> integers;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      integers[i][k] = mantissas[i][k];
      if (mantissas[i][k] != 0) integers[i][k] <<= static_cast<unsigned>(exponents[i][k] - lowest);
    }
  }
  return integers;
}

int exact_orientation(Vec2 a, Vec2 b, Vec2 c) {
  const auto p = to_integers<3>({a, b, c});
  const cpp_int left = (p[0][0] - p[2][0]) * (p[1][1] - p[2][1]);
  const cpp_int right = (p[0][1] - p[2][1]) * (p[1][0] - p[2][0]);
  return left.compare(right);
}

int exact_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const auto p = to_integers<4>({a, b, c, d});
  std::array<cpp_int, 3> x, y, lift;
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = p[i][0] - p[3][0];
    y[i] = p[i][1] - p[3][1];
    lift[i] = x[i] * x[i] + y[i] * y[i];
  }
  const cpp_int determinant = lift[0] * (x[1] * y[2] - x[2] * y[1]) + lift[1] * (x[2] * y[0] - x[0] * y[2]) +
                              lift[2] * (x[0] * y[1] - x[1] * y[0]);
  return determinant.sign();
}

}  // namespace

int orientation(Vec2 a, Vec2 b, Vec2 c) {
  const double acx = a.real() - c.real();
  const double bcy = b.imag() - c.imag();
  const double acy = a.imag() - c.imag();
  const double bcx = b.real() - c.real();
  const double left = acx * bcy;
  const double right = acy * bcx;
  const double determinant = left - right;
  const double bound = orientation_bound * (std::abs(left) + std::abs(right));
  if (std::abs(determinant) > bound + smallest_safe) return sign(determinant);
  // A difference of doubles is zero only if they are equal: lines along the axes need no exact arithmetic.
  if ((acx == 0 || bcy == 0) && (acy == 0 || bcx == 0)) return 0;
  const int result = exact_orientation(a, b, c);
  return (result > 0) - (result < 0);
}

int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double adx = a.real() - d.real(), ady = a.imag() - d.imag();
  const double bdx = b.real() - d.real(), bdy = b.imag() - d.imag();
  const double cdx = c.real() - d.real(), cdy = c.imag() - d.imag();
  const double bc = bdx * cdy, cb = cdx * bdy;
  const double ca = cdx * ady, ac = adx * cdy;
  const double ab = adx * bdy, ba = bdx * ady;
  const double a_lift = adx * adx + ady * ady;
  const double b_lift = bdx * bdx + bdy * bdy;
  const double c_lift = cdx * cdx + cdy * cdy;
  const double determinant = a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba);
  const double permanent = a_lift * (std::abs(bc) + std::abs(cb)) + b_lift * (std::abs(ca) + std::abs(ac)) +
                           c_lift * (std::abs(ab) + std::abs(ba));
  if (std::abs(determinant) > in_circle_bound * permanent + smallest_safe) return sign(determinant);
  return exact_in_circle(a, b, c, d);
}

}  // namespace applique
