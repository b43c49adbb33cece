#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/image/image_frame.h"
#include "applique/region/edge_grid.h"
#include "applique/region/edge_tree.h"

namespace applique {

/// The part of the image that is stuck on the surface: the closed set bounded by one simple polygon (§2 of
/// the paper), in the decal's plane. All yes-or-no answers come from exact predicates; queries use a grid
/// over the polygon's edges, so that they do not slow down with the number of its vertices.
class Region {
 public:
  /// `contour` in pixels, either orientation, not repeated at the end; consecutive duplicates are dropped.
  /// Errors: region_empty (fewer than 3 distinct vertices, no area, not finite), contour_self_crossing (names
  /// the two edges and the place in pixels).
  static Result<Region> from_contour(const std::vector<Pixel>& contour, const ImageFrame& frame);

  [[nodiscard]] const ImageFrame& frame() const { return frame_; }
  /// The polygon in the plane, counter-clockwise.
  [[nodiscard]] const std::vector<Vec2>& polygon() const { return polygon_; }
  /// The polygon in pixels, in the order of `polygon()`, with the coordinates that were given.
  [[nodiscard]] const std::vector<Pixel>& contour() const { return contour_; }
  [[nodiscard]] double area() const { return area_; }          ///< Plane units squared.
  [[nodiscard]] double diameter() const { return diameter_; }  ///< Diagonal of the bounding box, plane units.

  /// Whether z lies in the closed region.
  [[nodiscard]] bool contains(Vec2 z) const;
  /// Whether the whole closed segment lies in the closed region (§2.2 of the design): it may touch the
  /// contour but not cross it.
  [[nodiscard]] bool contains_segment(Vec2 a, Vec2 b) const;
  /// Whether the closed segment has a point in the region's interior.
  [[nodiscard]] bool meets_segment(Vec2 a, Vec2 b) const;
  /// Whether the triangle and the region's interior have a point in common.
  [[nodiscard]] bool meets_triangle(Vec2 a, Vec2 b, Vec2 c) const;
  /// Distance to the contour, plane units, positive inside.
  [[nodiscard]] double signed_distance(Vec2 z) const;

 private:
  /// How a segment meets the contour.
  struct Contact {
    bool touches = false;  ///< The contour at all.
    bool leaves = false;   ///< From a contact it goes on outside the closed region.
    bool enters = false;   ///< From a contact it goes on in the interior.
  };
  [[nodiscard]] Contact contact_of(Vec2 a, Vec2 b) const;
  void add_edge_contact(std::uint32_t edge, Vec2 a, Vec2 b, Contact& contact) const;
  [[nodiscard]] Vec2 vertex(std::size_t i) const { return polygon_[i == polygon_.size() ? 0 : i]; }
  [[nodiscard]] bool crosses_edge(Vec2 a, Vec2 b, std::uint32_t edge) const;
  void classify_cells();

  ImageFrame frame_;
  std::vector<Vec2> polygon_;
  std::vector<Pixel> contour_;
  double area_ = 0;
  double diameter_ = 0;
  Vec2 low_, high_;  ///< The bounding box.
  EdgeGrid grid_;
  EdgeTree tree_;
  std::vector<Vec2> references_;  ///< By cell: a point of it that is not on the contour.
  std::vector<char> inside_;      ///< By cell: whether its reference is inside.
};

}  // namespace applique
