#include "uv_coverage.h"

#include <algorithm>
#include <cmath>

namespace applique {

UvCoverage::UvCoverage(int size, WrapMode wrap_u, WrapMode wrap_v)
    : size_(size), wrap_u_(wrap_u), wrap_v_(wrap_v), counts_(static_cast<std::size_t>(size) * size, 0) {}

int UvCoverage::wrap(std::int64_t texel, WrapMode mode) const {
  if (mode == WrapMode::clamp) return static_cast<int>(std::clamp<std::int64_t>(texel, 0, size_ - 1));
  const std::int64_t period = mode == WrapMode::repeat ? size_ : 2 * size_;
  const auto remainder = static_cast<int>(((texel % period) + period) % period);
  return remainder < size_ ? remainder : 2 * size_ - 1 - remainder;
}

void UvCoverage::add(const std::array<std::array<double, 2>, 3>& uvs) {
  std::array<std::array<double, 2>, 3> p = uvs;
  for (auto& point : p)
    for (double& x : point) x = x * size_ - 0.5;  // Texel centres are whole numbers from here on.
  const auto [lowest, highest] = std::minmax({p[0][1], p[1][1], p[2][1]});
  const auto [leftmost, rightmost] = std::minmax({p[0][0], p[1][0], p[2][0]});
  // One triangle over many repeats of the texture covers all of it more than once.
  constexpr double many = 16;
  if (!((highest - lowest) < many * size_ && (rightmost - leftmost) < many * size_)) {
    std::fill(counts_.begin(), counts_.end(), std::uint8_t{2});
    return;
  }
  for (auto y = static_cast<std::int64_t>(std::ceil(lowest)); static_cast<double>(y) < highest; ++y) {
    double left = rightmost;
    double right = leftmost;
    for (std::size_t k = 0; k < 3; ++k) {
      auto a = p[k];
      auto b = p[(k + 1) % 3];
      // The same arithmetic for both triangles at an edge, so that no centre counts twice.
      if (a[1] > b[1]) std::swap(a, b);
      const auto row = static_cast<double>(y);
      if (row < a[1] || row >= b[1]) continue;
      const double x = a[0] + (b[0] - a[0]) * ((row - a[1]) / (b[1] - a[1]));
      left = std::min(left, x);
      right = std::max(right, x);
    }
    std::uint8_t* line =
        &counts_[static_cast<std::size_t>(wrap(y, wrap_v_)) * static_cast<std::size_t>(size_)];
    for (auto x = static_cast<std::int64_t>(std::ceil(left)); static_cast<double>(x) < right; ++x) {
      std::uint8_t& count = line[wrap(x, wrap_u_)];
      if (count < 2) ++count;
    }
  }
}

double UvCoverage::covered() const {
  const auto empty = std::count(counts_.begin(), counts_.end(), std::uint8_t{0});
  return 1 - static_cast<double>(empty) / static_cast<double>(counts_.size());
}

double UvCoverage::shared() const {
  const auto empty = std::count(counts_.begin(), counts_.end(), std::uint8_t{0});
  const auto shared = std::count(counts_.begin(), counts_.end(), std::uint8_t{2});
  const auto covered = static_cast<std::ptrdiff_t>(counts_.size()) - empty;
  return covered == 0 ? 0 : static_cast<double>(shared) / static_cast<double>(covered);
}

}  // namespace applique
