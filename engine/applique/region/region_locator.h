#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/triangulation.h"

namespace applique {

/// A place in a triangulated region.
struct RegionLocation {
  std::uint32_t triangle;
  std::array<double, 3> barycentric;  ///< >= 0, sum 1.
};

/// Finds places in a triangulated region: a binary tree of boxes over its triangles. O(log n) a query, for
/// points far outside, too.
class RegionLocator {
 public:
  RegionLocator() = default;
  /// `mesh` has at least one triangle; it is not kept.
  explicit RegionLocator(const RegionTriangulation& mesh);

  /// The place of z, or, for z outside the region, of the region's nearest point.
  [[nodiscard]] RegionLocation locate(Vec2 z) const;

 private:
  struct Leaf {
    std::array<Vec2, 3> corners;
    std::uint32_t triangle;
  };
  struct Box {
    Vec2 low, high;
    [[nodiscard]] double squared_distance(Vec2 z) const;
  };
  void build(std::size_t node, std::size_t begin, std::size_t end);

  std::vector<Leaf> leaves_;  ///< In the tree's order.
  std::vector<Box> boxes_;    ///< Node k has the children 2 k + 1 and 2 k + 2, which halve its leaves.
};

}  // namespace applique
