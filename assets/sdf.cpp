#include "sdf.h"

#include <limits>

namespace applique::assets {

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
  const Vec3 scaled = (p - centre).cwiseQuotient(radii);
  const double k0 = scaled.norm();
  const double k1 = scaled.cwiseQuotient(radii).norm();
  if (k1 < 1e-9) return -radii.minCoeff();
  return k0 * (k0 - 1) / k1;
}

double round_cone(const Vec3& p, const Knot& a, const Knot& b) {
  const Vec3 axis = b.point - a.point;
  const double length2 = axis.squaredNorm();
  const double narrowing = a.radius - b.radius;
  const double slant2 = length2 - narrowing * narrowing;
  const Vec3 from_a = p - a.point;
  const double y = from_a.dot(axis);
  const double z = y - length2;
  const double x2 = (from_a * length2 - axis * y).squaredNorm();
  const double y2 = y * y * length2;
  const double z2 = z * z * length2;
  const double k = std::copysign(narrowing * narrowing * x2, narrowing);
  if (std::copysign(slant2 * z2, z) > k) return std::sqrt(x2 + z2) / length2 - b.radius;
  if (std::copysign(slant2 * y2, y) < k) return std::sqrt(x2 + y2) / length2 - a.radius;
  return (std::sqrt(x2 * slant2 / length2) + y * narrowing) / length2 - a.radius;
}

double tube(const Vec3& p, std::span<const Knot> knots) {
  double distance = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    distance = std::min(distance, round_cone(p, knots[i], knots[i + 1]));
  return distance;
}

double drum(const Vec3& p, double radius, double low, double high, double rounding) {
  const double across = std::hypot(p.x(), p.z()) - radius + rounding;
  const double along = std::abs(p.y() - 0.5 * (low + high)) - 0.5 * (high - low) + rounding;
  return std::min(std::max(across, along), 0.0) + std::hypot(std::max(across, 0.0), std::max(along, 0.0)) -
         rounding;
}

}  // namespace applique::assets
