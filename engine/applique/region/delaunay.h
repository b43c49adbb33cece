#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// A constrained Delaunay triangulation while it is built, inside a box that holds all points, so that every
/// edge of interest has two sides. All decisions come from exact predicates, and changes are flips and splits
/// alone, so that it is valid at any time.
///
/// Edge e = 3 t + k of triangle t is opposite corner k and runs counter-clockwise from `from(e)` to `to(e)`.
/// The points 0 to 3 are the box's corners.
class DelaunayMesh {
 public:
  static constexpr std::uint32_t box_corners = 4;

  /// All points will lie within `reach` of `middle`.
  DelaunayMesh(Vec2 middle, double reach);

  /// Adds a point and returns its number, or the number of the point that is there. The walk to it starts at
  /// the point added before. Only while no edge is fixed.
  std::uint32_t insert(Vec2 z);
  /// Adds a point strictly inside the triangle or on one of its edges that is not fixed.
  std::uint32_t insert_into(std::int32_t triangle, Vec2 z);
  /// Makes the straight line from a to b an edge that stays, in pieces where points lie on it: those points
  /// in order, a and b included. Must not cross a fixed edge.
  std::vector<std::uint32_t> fix(std::uint32_t a, std::uint32_t b);
  /// Splits a fixed edge in its middle, or at a point that lies on it up to rounding. Nothing happens, and
  /// nothing is returned, where a triangle would turn over or the inside come apart.
  std::optional<std::uint32_t> split_fixed(std::int32_t edge);
  /// The points on what was the edge from a to b when it was fixed, all of them by now.
  [[nodiscard]] std::vector<std::uint32_t> pieces(std::uint32_t a, std::uint32_t b) const;

  /// Marks the triangles that fixed edges shut off from the box as inside. Later changes keep the marks.
  void mark_inside();
  [[nodiscard]] bool inside(std::int32_t triangle) const { return inside_[triangle] != 0; }

  /// Where a straight walk inside the triangulation ends.
  struct Walk {
    std::int32_t triangle = -1;  ///< That holds the goal, or -1.
    std::int32_t wall = -1;      ///< The fixed edge that the walk stopped at, or -1.
  };
  /// From the middle of a triangle towards z, up to the first fixed edge.
  [[nodiscard]] Walk walk(std::int32_t triangle, Vec2 z) const;
  /// A fixed edge whose diametral circle holds z, of those round the triangles that z in `triangle` would
  /// replace; -1 if there is none.
  [[nodiscard]] std::int32_t encroached_by(Vec2 z, std::int32_t triangle) const;

  [[nodiscard]] const std::vector<Vec2>& points() const { return points_; }
  [[nodiscard]] std::size_t triangles() const { return corner_.size() / 3; }
  [[nodiscard]] std::uint32_t corner(std::int32_t edge) const { return corner_[edge]; }  ///< Opposite it.
  [[nodiscard]] std::uint32_t from(std::int32_t edge) const { return corner_[next(edge)]; }
  [[nodiscard]] std::uint32_t to(std::int32_t edge) const { return corner_[previous(edge)]; }
  [[nodiscard]] std::int32_t twin(std::int32_t edge) const { return twin_[edge]; }  ///< -1 at the box.
  [[nodiscard]] bool fixed(std::int32_t edge) const { return fixed_[edge] != 0; }

  static std::int32_t next(std::int32_t edge) { return edge % 3 == 2 ? edge - 2 : edge + 1; }
  static std::int32_t previous(std::int32_t edge) { return edge % 3 == 0 ? edge + 2 : edge - 1; }

  /// Calls `visit(edge)` for the edges opposite the point in the triangles round it.
  template <class Visit>
  void visit_star(std::uint32_t point, Visit&& visit) const {
    const std::int32_t first = opposite_[point];
    std::int32_t edge = first;
    do {
      visit(edge);
      edge = turned(edge);
    } while (edge != first);
  }

 private:
  [[nodiscard]] Vec2 at(std::uint32_t point) const { return points_[point]; }
  [[nodiscard]] int side(std::int32_t edge, Vec2 z) const;
  /// The edge opposite the same corner in the next triangle round it, counter-clockwise.
  [[nodiscard]] std::int32_t turned(std::int32_t edge) const { return next(twin_[next(edge)]); }
  [[nodiscard]] std::int32_t edge_between(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] bool can_flip(std::int32_t edge) const;

  void set_corner(std::int32_t edge, std::uint32_t point);
  void join(std::int32_t edge, std::int32_t twin, char fixed);
  std::int32_t add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, char inside);
  void flip(std::int32_t edge);
  void split_triangle(std::int32_t edge, std::uint32_t point);
  void split_edge(std::int32_t edge, std::uint32_t point);
  std::optional<std::uint32_t> bend(std::int32_t edge);
  void restore_delaunay(std::vector<std::int32_t> edges);
  void restore_star(std::uint32_t point);
  void set_fixed(std::int32_t edge);
  void clear_way(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>> crossed);

  std::vector<Vec2> points_;
  std::vector<std::int32_t> opposite_;  ///< By point: an edge that it is the opposite corner of.
  std::vector<std::uint32_t> corner_;   ///< By edge.
  std::vector<std::int32_t> twin_;      ///< By edge.
  std::vector<char> fixed_;             ///< By edge.
  std::vector<char> inside_;            ///< By triangle.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;  ///< Of fixed edges split since.
};

}  // namespace applique
