#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// Lengths of shortest paths between points that stay inside a simple polygon: the polygon is cut into
/// triangles once; their dual graph is a tree, so that a path's sleeve is unique and a funnel (Lee and
/// Preparata 1984) pulls it tight.
class InnerGeodesics {
 public:
  /// `polygon` is simple and counter-clockwise; `points` lie in it. Expected time O(n reflex vertices).
  InnerGeodesics(const std::vector<Vec2>& polygon, const std::vector<Vec2>& points);

  /// Lengths of the shortest inner paths from point `source` to every point. O(n points).
  [[nodiscard]] std::vector<double> lengths(std::size_t source) const;

 private:
  struct Triangle {
    std::array<std::uint32_t, 3> vertices;   ///< Counter-clockwise.
    std::array<std::int32_t, 3> neighbours;  ///< Across the edge from corner k to k + 1; -1 at the polygon.
  };
  void cut_ears();
  void link_triangles();
  [[nodiscard]] std::int32_t triangle_of(Vec2 z) const;

  std::vector<Vec2> polygon_;
  std::vector<Triangle> triangles_;
  std::vector<Vec2> points_;
  std::vector<std::int32_t> homes_;  ///< By point: the triangle that it lies in.
};

}  // namespace applique
