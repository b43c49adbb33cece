#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "applique/transfer/transfer.h"

namespace applique {

/// The column or row of a texture of `size` texels that the sampler shows at `texel`, which may lie outside.
inline int wrap_texel(std::int64_t texel, int size, WrapMode mode) {
  if (mode == WrapMode::clamp) return static_cast<int>(std::clamp<std::int64_t>(texel, 0, size - 1));
  const std::int64_t period = mode == WrapMode::repeat ? size : 2 * std::int64_t{size};
  const auto remainder = static_cast<int>(((texel % period) + period) % period);
  return remainder < size ? remainder : 2 * size - 1 - remainder;
}

/// Calls `visit(x, y)` for every texel whose centre lies in the triangle, row by row. Of two triangles on
/// either side of an edge through a centre, one has it.
template <class Visit>
void for_each_texel(const std::array<Texel, 3>& corners, const Visit& visit) {
  std::array<Texel, 3> p = corners;
  for (Texel& point : p)
    for (double& x : point) x -= 0.5;  // Texel centres are whole numbers from here on.
  const auto [lowest, highest] = std::minmax({p[0][1], p[1][1], p[2][1]});
  const auto [leftmost, rightmost] = std::minmax({p[0][0], p[1][0], p[2][0]});
  for (auto y = static_cast<std::int64_t>(std::ceil(lowest)); static_cast<double>(y) < highest; ++y) {
    double left = rightmost;
    double right = leftmost;
    for (std::size_t k = 0; k < 3; ++k) {
      Texel a = p[k];
      Texel b = p[(k + 1) % 3];
      // The same arithmetic for both triangles at an edge, so that no centre counts twice.
      if (a[1] > b[1]) std::swap(a, b);
      const auto row = static_cast<double>(y);
      if (row < a[1] || row >= b[1]) continue;
      const double x = a[0] + (b[0] - a[0]) * ((row - a[1]) / (b[1] - a[1]));
      left = std::min(left, x);
      right = std::max(right, x);
    }
    for (auto x = static_cast<std::int64_t>(std::ceil(left)); static_cast<double>(x) < right; ++x)
      visit(x, y);
  }
}

}  // namespace applique
