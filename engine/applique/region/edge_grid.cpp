#include "applique/region/edge_grid.h"

#include <cmath>

namespace applique {

EdgeGrid::EdgeGrid(const std::vector<Vec2>& polygon) {
  Vec2 low = polygon[0], high = polygon[0];
  for (const Vec2 z : polygon) {
    low = {std::min(low.real(), z.real()), std::min(low.imag(), z.imag())};
    high = {std::max(high.real(), z.real()), std::max(high.imag(), z.imag())};
  }
  const Vec2 extent = high - low;
  const double wanted = std::clamp(16.0 * static_cast<double>(polygon.size()), 1024.0, 262144.0);
  const double longest = std::max(extent.real(), extent.imag());
  // A region as thin as a line gets cells by its length alone.
  size_ = std::max(std::sqrt(extent.real() * extent.imag() / wanted), longest / wanted);
  inverse_ = 1 / size_;
  columns_ = static_cast<int>(extent.real() * inverse_) + 3;
  rows_ = static_cast<int>(extent.imag() * inverse_) + 3;
  origin_ = 0.5 * (low + high) - 0.5 * size_ * Vec2(columns_, rows_);

  const auto for_each_entry = [&](auto&& entry) {
    for (std::uint32_t i = 0; i < polygon.size(); ++i) {
      visit_cells(polygon[i], polygon[(i + 1) % polygon.size()], [&](int cell) {
        entry(cell, i);
        return true;
      });
    }
  };
  first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  for_each_entry([&](int cell, std::uint32_t) { ++first_[cell + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  edges_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_entry([&](int cell, std::uint32_t edge) { edges_[next[cell]++] = edge; });
}

}  // namespace applique
