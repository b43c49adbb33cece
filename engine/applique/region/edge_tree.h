#pragma once

#include <cstdint>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// Distances to a closed polygon: a binary tree of boxes over its edges in their order, since edges that
/// follow each other lie together. O(log n) a query where the polygon is not curled up around the point.
class EdgeTree {
 public:
  EdgeTree() = default;
  explicit EdgeTree(const std::vector<Vec2>& polygon);

  /// Squared distance from z to the nearest edge.
  [[nodiscard]] double squared_distance(Vec2 z) const;

 private:
  struct Box {
    Vec2 low, high;
    [[nodiscard]] double squared_distance(Vec2 z) const;
  };
  void search(Vec2 z, std::size_t node, double& best) const;

  std::vector<Vec2> ends_;  ///< The vertices, the first once more at the end.
  std::vector<Box> boxes_;  ///< A heap: node k has the children 2 k + 1 and 2 k + 2; the leaves come last.
  std::size_t leaves_ = 0;  ///< A power of two.
};

}  // namespace applique
