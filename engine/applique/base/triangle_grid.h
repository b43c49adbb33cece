#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// A uniform grid over triangles of the plane: which of those that were put in may meet a box.
class TriangleGrid {
 public:
  using Triangle = std::array<Vec2, 3>;

  /// For triangles within the bounding box of `all`; about as many cells as they are. All are finite.
  explicit TriangleGrid(const std::vector<Triangle>& all);

  void insert(std::uint32_t id, const Triangle& triangle);

  /// Calls `visit(id)` for every triangle put in that shares a cell with this one's bounding box, once for
  /// each such cell; stops when it returns true, and returns whether it did.
  template <class Visit>
  bool any_near(const Triangle& triangle, const Visit& visit) const {
    const auto [left, right, bottom, top] = cells(triangle);
    for (int y = bottom; y <= top; ++y)
      for (int x = left; x <= right; ++x) {
        const auto& cell = cells_[static_cast<std::size_t>(y) * columns_ + x];
        if (std::any_of(cell.begin(), cell.end(), visit)) return true;
      }
    return false;
  }

 private:
  [[nodiscard]] std::array<int, 4> cells(const Triangle& triangle) const;

  Vec2 origin_ = 0;
  double size_ = 1;  ///< Of a cell.
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace applique
