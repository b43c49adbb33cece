#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "applique/base/types.h"

/// Signed distance functions: negative inside, in scene units. The ellipsoid's is a first-order estimate; all
/// others are exact for the primitive and bounds after blending. Formulas after I. Quilez's catalogue of
/// distance functions and his polynomial smooth minimum.
namespace applique::assets {

/// A tube's skeleton point and its radius there.
struct Knot {
  Vec3 point;
  double radius;
};

/// Union of a and b with a fillet about `k` wide; equals min(a, b) where |a - b| >= k.
inline double smooth_union(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

/// What is in both a and b, with the edge rounded over about `k`.
inline double smooth_intersection(double a, double b, double k) {
  return -smooth_union(-a, -b, k);
}

/// a without b.
inline double smooth_difference(double a, double b, double k) {
  return -smooth_union(-a, b, k);
}

/// Cubic step from 0 at `low` to 1 at `high`.
inline double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

inline double sphere(const Vec3& p, const Vec3& centre, double radius) {
  return (p - centre).norm() - radius;
}

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii);

/// The hull of two spheres.
double round_cone(const Vec3& p, const Knot& a, const Knot& b);

/// Round cones along the knots.
double tube(const Vec3& p, std::span<const Knot> knots);

/// A disc of the given radius around the y axis, from `low` to `high`, with its rims rounded.
double drum(const Vec3& p, double radius, double low, double high, double rounding);

}  // namespace applique::assets
