#include "applique/base/triangle_grid.h"

#include <cmath>
#include <limits>

namespace applique {

TriangleGrid::TriangleGrid(const std::vector<Triangle>& all) {
  if (!all.empty()) {
    constexpr double far = std::numeric_limits<double>::infinity();
    double left = far, right = -far, bottom = far, top = -far;
    for (const Triangle& triangle : all)
      for (const Vec2 z : triangle) {
        left = std::min(left, z.real());
        right = std::max(right, z.real());
        bottom = std::min(bottom, z.imag());
        top = std::max(top, z.imag());
      }
    origin_ = {left, bottom};
    // A strip may be as thin as a line: no more cells along it than there are triangles.
    const double width = right - left, height = top - bottom, count = static_cast<double>(all.size());
    size_ = std::max(std::sqrt(width * height / count), std::max(width, height) / count);
    if (!(size_ > 0)) size_ = 1;
    columns_ = 1 + static_cast<int>(width / size_);
    rows_ = 1 + static_cast<int>(height / size_);
  }
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

void TriangleGrid::insert(std::uint32_t id, const Triangle& triangle) {
  const auto [left, right, bottom, top] = cells(triangle);
  for (int y = bottom; y <= top; ++y)
    for (int x = left; x <= right; ++x) cells_[static_cast<std::size_t>(y) * columns_ + x].push_back(id);
}

std::array<int, 4> TriangleGrid::cells(const Triangle& triangle) const {
  const auto index = [&](double at, int count) {
    return static_cast<int>(std::clamp(at / size_, 0.0, count - 1.0));
  };
  const auto [left, right] = std::minmax({triangle[0].real(), triangle[1].real(), triangle[2].real()});
  const auto [bottom, top] = std::minmax({triangle[0].imag(), triangle[1].imag(), triangle[2].imag()});
  return {index(left - origin_.real(), columns_), index(right - origin_.real(), columns_),
          index(bottom - origin_.imag(), rows_), index(top - origin_.imag(), rows_)};
}

}  // namespace applique
