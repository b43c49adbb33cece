#include "applique/embed/collapse.h"

#include <algorithm>
#include <cmath>

namespace applique {
namespace {

double collapse_time(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  const Vec2 e = a[1] - a[0], f = a[2] - a[0];
  const Vec2 de = b[1] - b[0] - e, df = b[2] - b[0] - f;
  const double c0 = cross(e, f), c1 = cross(de, f) + cross(e, df), c2 = cross(de, df);
  const double discriminant = c1 * c1 - 4 * c2 * c0;
  if (discriminant < 0) return 2;
  // Stable roots of c2 t^2 + c1 t + c0.
  const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
  double first = 2;
  for (const double t : {q != 0 ? c0 / q : 2, c2 != 0 ? q / c2 : 2})
    if (t > 0 && t <= 1) first = std::min(first, t);
  return first;
}

}  // namespace

double first_collapse(const DiscGeometry& disc, std::span<const Vec2> start, std::span<const Vec2> goal) {
  double first = 2;
  for (const auto& f : disc.faces)
    first = std::min(
        first, collapse_time({start[f[0]], start[f[1]], start[f[2]]}, {goal[f[0]], goal[f[1]], goal[f[2]]}));
  return first;
}

}  // namespace applique
