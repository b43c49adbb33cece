#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "applique/base/types.h"

namespace applique {

bool in_box(Vec2 z, Vec2 a, Vec2 b);              ///< In the bounding box of a and b.
bool boxes_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d);  ///< The bounding boxes of a, b and of c, d.

/// Where the edges e < f of a polygon meet and those of a simple polygon must not: a point of one on the
/// other, or for neighbours, folding back on each other.
std::optional<Vec2> improper_meeting(const std::vector<Vec2>& polygon, std::uint32_t e, std::uint32_t f);

/// A uniform grid over the edges of a closed polygon: which edges may meet a cell. Edge i runs from vertex i
/// to vertex i + 1. The outermost cells all round touch no edge and lie outside the polygon.
class EdgeGrid {
 public:
  EdgeGrid() = default;
  /// About 16 cells an edge, so that few cells hold more than two. `polygon` is finite, not a single point.
  explicit EdgeGrid(const std::vector<Vec2>& polygon);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double cell_size() const { return size_; }  ///< Plane units.

  /// The column of x and the row of y, clamped to the grid; both are monotone, with any rounding.
  [[nodiscard]] int column(double x) const { return index((x - origin_.real()) * inverse_, columns_); }
  [[nodiscard]] int row(double y) const { return index((y - origin_.imag()) * inverse_, rows_); }
  [[nodiscard]] int cell(int column, int row) const { return row * columns_ + column; }
  [[nodiscard]] Vec2 cell_centre(int column, int row) const {
    return origin_ + size_ * Vec2(column + 0.5, row + 0.5);
  }

  /// All edges that meet the cell, ascending; some of them may pass it by a hair.
  [[nodiscard]] std::span<const std::uint32_t> edges(int cell) const {
    return {edges_.data() + first_[cell], edges_.data() + first_[cell + 1]};
  }

  /// Calls `visit(e, f)`, e < f, for all edges that share a cell; more than once for those that share
  /// several.
  template <class Visit>
  void visit_pairs(Visit&& visit) const {
    for (int cell = 0; cell < columns_ * rows_; ++cell) {
      const auto list = edges(cell);
      for (std::size_t i = 0; i < list.size(); ++i) {
        for (std::size_t j = i + 1; j < list.size(); ++j) visit(list[i], list[j]);
      }
    }
  }

  /// Calls `visit(cell)` for every cell that the segment meets, and perhaps neighbours that it passes by a
  /// hair, row by row; stops when it returns false.
  template <class Visit>
  void visit_cells(Vec2 a, Vec2 b, Visit&& visit) const {
    const double slack = 1e-9 * size_;
    if (a.imag() > b.imag()) std::swap(a, b);
    const double left = std::min(a.real(), b.real()), right = std::max(a.real(), b.real());
    const int last_row = row(b.imag() + slack);
    for (int y = row(a.imag() - slack); y <= last_row; ++y) {
      double from = left, to = right;
      if (a.imag() < b.imag()) {  // The stretch of the segment in this row.
        const double slope = (b.real() - a.real()) / (b.imag() - a.imag());
        const double bottom = y == 0 ? a.imag() : origin_.imag() + y * size_ - slack;
        const double top = y == rows_ - 1 ? b.imag() : origin_.imag() + (y + 1) * size_ + slack;
        const double x0 = bottom <= a.imag() ? a.real() : a.real() + (bottom - a.imag()) * slope;
        const double x1 = top >= b.imag() ? b.real() : a.real() + (top - a.imag()) * slope;
        from = std::clamp(std::min(x0, x1), left, right);
        to = std::clamp(std::max(x0, x1), left, right);
      }
      const int last_column = column(to + slack);
      for (int x = column(from - slack); x <= last_column; ++x) {
        if (!visit(cell(x, y))) return;
      }
    }
  }

 private:
  static int index(double value, int count) {
    return value >= count ? count - 1 : value > 0 ? static_cast<int>(value) : 0;
  }

  Vec2 origin_;
  double size_ = 1;
  double inverse_ = 1;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> edges_;
};

}  // namespace applique
