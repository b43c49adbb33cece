#include "applique/region/region.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "applique/base/predicates.h"

namespace applique {
namespace {

/// Where q lies as seen from the polygon's vertex v between `before` and `after`: +1 in the open interior
/// cone, 0 along one of the two edges, -1 outside.
int side_of_cone(Vec2 before, Vec2 v, Vec2 after, Vec2 q) {
  const int in = orientation(before, v, q);
  const int out = orientation(v, after, q);
  const int turn = orientation(before, v, after);
  if (turn > 0) return std::min(in, out);
  if (turn < 0) return std::max(in, out);
  return in;
}

struct Crossing {
  std::uint32_t first, second;  ///< Edges, first < second.
  Vec2 place;
};

/// The first pair of edges, in lexicographic order, that meet where a simple polygon's must not.
std::optional<Crossing> find_crossing(const std::vector<Vec2>& polygon, const EdgeGrid& grid) {
  std::optional<Crossing> found;
  grid.visit_pairs([&](std::uint32_t e, std::uint32_t f) {
    if (found && std::pair(e, f) >= std::pair(found->first, found->second)) return;
    if (const auto place = improper_meeting(polygon, e, f)) found = Crossing{e, f, *place};
  });
  return found;
}

/// In pixels, as they were given: turning them into plane coordinates may bend a line by its rounding.
bool all_collinear(const std::vector<Pixel>& contour) {
  const auto point = [&](std::size_t i) { return Vec2(contour[i].x, contour[i].y); };
  for (std::size_t i = 2; i < contour.size(); ++i) {
    if (orientation(point(0), point(1), point(i)) != 0) return false;
  }
  return true;
}

}  // namespace

Result<Region> Region::from_contour(const std::vector<Pixel>& contour, const ImageFrame& frame) {
  Region region;
  region.frame_ = frame;
  for (const Pixel p : contour) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
      return fail(
          ErrorCode::region_empty,
          fmt::format("contour vertex {} is not finite; give numbers in pixels", &p - contour.data()));
    }
    const Vec2 z = frame.to_plane(p);
    if (!region.polygon_.empty() && region.polygon_.back() == z) continue;
    region.polygon_.push_back(z);
    region.contour_.push_back(p);
  }
  auto& polygon = region.polygon_;
  while (polygon.size() > 1 && polygon.front() == polygon.back()) {
    polygon.pop_back();
    region.contour_.pop_back();
  }
  if (polygon.size() < 3 || all_collinear(region.contour_)) {
    return fail(
        ErrorCode::region_empty,
        fmt::format("the contour encloses no area: its {} distinct {} on one line; draw it around the "
                    "part of the image to use",
                    polygon.size(), polygon.size() == 1 ? "vertex lies" : "vertices lie"));
  }
  region.grid_ = EdgeGrid(polygon);
  if (const auto crossing = find_crossing(polygon, region.grid_)) {
    const Pixel place = frame.to_pixel(crossing->place);
    const auto edge_name = [&](std::uint32_t edge) {
      const Pixel a = region.contour_[edge], b = region.contour_[(edge + 1) % region.contour_.size()];
      return fmt::format("({:.6g}, {:.6g})-({:.6g}, {:.6g})", a.x, a.y, b.x, b.y);
    };
    return fail(
        ErrorCode::contour_self_crossing,
        fmt::format("the contour crosses or touches itself at ({:.2f}, {:.2f}) px: edges {} and {}; it "
                    "has to be one simple closed curve",
                    place.x, place.y, edge_name(crossing->first), edge_name(crossing->second)));
  }

  double twice_area = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice_area += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  if (twice_area < 0) {
    std::reverse(polygon.begin(), polygon.end());
    std::reverse(region.contour_.begin(), region.contour_.end());
    region.grid_ = EdgeGrid(polygon);
  }
  region.area_ = 0.5 * std::abs(twice_area);
  region.low_ = region.high_ = polygon[0];
  for (const Vec2 z : polygon) {
    region.low_ = {std::min(region.low_.real(), z.real()), std::min(region.low_.imag(), z.imag())};
    region.high_ = {std::max(region.high_.real(), z.real()), std::max(region.high_.imag(), z.imag())};
  }
  region.diameter_ = std::abs(region.high_ - region.low_);
  region.classify_cells();
  region.tree_ = EdgeTree(polygon);
  return region;
}

// The reference of each cell, and whether it is inside: known outside in the first column, then from cell to
// cell by the parity of the edges crossed on the way.
void Region::classify_cells() {
  const int columns = grid_.columns(), rows = grid_.rows();
  references_.resize(static_cast<std::size_t>(columns) * rows);
  inside_.assign(references_.size(), 0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int cell = grid_.cell(x, y);
      const auto on_contour = [&](Vec2 z) {
        const auto edges = grid_.edges(cell);
        return std::any_of(edges.begin(), edges.end(), [&](std::uint32_t e) {
          return in_box(z, polygon_[e], vertex(e + 1)) && orientation(polygon_[e], vertex(e + 1), z) == 0;
        });
      };
      Vec2 z = grid_.cell_centre(x, y);
      for (int attempt = 1; on_contour(z); ++attempt) {  // Finitely many edges: points on no line end this.
        const double turns = 2.399963 * attempt;
        z = grid_.cell_centre(x, y) + grid_.cell_size() * std::polar(0.4 * attempt / (attempt + 8.0), turns);
      }
      references_[cell] = z;
      if (x == 0) continue;
      bool inside = inside_[cell - 1] != 0;
      const auto before = grid_.edges(cell - 1);
      for (const std::uint32_t e : before) inside ^= crosses_edge(references_[cell - 1], z, e);
      for (const std::uint32_t e : grid_.edges(cell)) {
        if (!std::binary_search(before.begin(), before.end(), e))
          inside ^= crosses_edge(references_[cell - 1], z, e);
      }
      inside_[cell] = inside ? 1 : 0;
    }
  }
}

// Whether the segment a b, neither end on the contour, crosses the edge when it is moved sideways by less
// than anything: a vertex right on the line counts as left of it, so that parities stay exact.
bool Region::crosses_edge(Vec2 a, Vec2 b, std::uint32_t edge) const {
  const Vec2 p = polygon_[edge], q = vertex(edge + 1);
  if (!boxes_meet(a, b, p, q)) return false;
  return (orientation(a, b, p) >= 0) != (orientation(a, b, q) >= 0) &&
         (orientation(p, q, a) > 0) != (orientation(p, q, b) > 0);
}

bool Region::contains(Vec2 z) const {
  if (!in_box(z, low_, high_)) return false;
  const int cell = grid_.cell(grid_.column(z.real()), grid_.row(z.imag()));
  bool inside = inside_[cell] != 0;
  for (const std::uint32_t e : grid_.edges(cell)) {
    const Vec2 p = polygon_[e], q = vertex(e + 1);
    if (in_box(z, p, q) && orientation(p, q, z) == 0) return true;
    inside ^= crosses_edge(z, references_[cell], e);
  }
  return inside;
}

void Region::add_edge_contact(std::uint32_t edge, Vec2 a, Vec2 b, Contact& contact) const {
  const Vec2 p = polygon_[edge], q = vertex(edge + 1);
  if (!boxes_meet(a, b, p, q)) return;
  const int side_p = orientation(a, b, p), side_q = orientation(a, b, q);
  if (side_p * side_q > 0) return;
  const int side_a = orientation(p, q, a), side_b = orientation(p, q, b);
  if (side_a * side_b > 0) return;
  if (side_p * side_q * side_a * side_b != 0) {
    contact.touches = contact.leaves = contact.enters = true;
    return;
  }
  const auto goes_on = [&](int side) {
    contact.leaves |= side < 0;
    contact.enters |= side > 0;
  };
  if (side_p == 0 && in_box(p, a, b)) {  // The edge's end is the next edge's start: every vertex is met once.
    contact.touches = true;
    const Vec2 before = polygon_[edge == 0 ? polygon_.size() - 1 : edge - 1];
    if (a != p) goes_on(side_of_cone(before, p, q, a));
    if (b != p) goes_on(side_of_cone(before, p, q, b));
  }
  if (side_a == 0 && a != p && a != q && in_box(a, p, q)) {
    contact.touches = true;
    goes_on(side_b);
  }
  if (side_b == 0 && b != p && b != q && in_box(b, p, q)) {
    contact.touches = true;
    goes_on(side_a);
  }
}

// The open pieces between two contacts lie wholly inside, outside or on the contour; the exact direction in
// which the segment goes on from a contact says which. No midpoint has to be computed, so nothing is rounded.
Region::Contact Region::contact_of(Vec2 a, Vec2 b) const {
  Contact contact;
  grid_.visit_cells(a, b, [&](int cell) {
    for (const std::uint32_t e : grid_.edges(cell)) add_edge_contact(e, a, b, contact);
    return !(contact.leaves && contact.enters);
  });
  return contact;
}

bool Region::contains_segment(Vec2 a, Vec2 b) const {
  if (!in_box(a, low_, high_) || !in_box(b, low_, high_)) return false;
  if (a == b) return contains(a);
  const Contact contact = contact_of(a, b);
  return !contact.leaves && (contact.touches || contains(a));
}

bool Region::meets_segment(Vec2 a, Vec2 b) const {
  if (!boxes_meet(a, b, low_, high_)) return false;
  const Contact contact = contact_of(a, b);
  return contact.enters || (!contact.touches && contains(a));
}

bool Region::meets_triangle(Vec2 a, Vec2 b, Vec2 c) const {
  const Vec2 low = {std::min({a.real(), b.real(), c.real()}), std::min({a.imag(), b.imag(), c.imag()})};
  const Vec2 high = {std::max({a.real(), b.real(), c.real()}), std::max({a.imag(), b.imag(), c.imag()})};
  if (!boxes_meet(low, high, low_, high_)) return false;
  if (in_box(a, low_, high_)) {
    const int cell = grid_.cell(grid_.column(a.real()), grid_.row(a.imag()));
    if (grid_.edges(cell).empty() && inside_[cell]) return true;
  }
  if (meets_segment(a, b) || meets_segment(b, c) || meets_segment(c, a)) return true;
  // The interior lies all inside or all outside the triangle: the first vertex off its border tells.
  const int turn = orientation(a, b, c);
  if (turn == 0) return false;
  for (const Vec2 z : polygon_) {
    const int side =
        std::min({turn * orientation(a, b, z), turn * orientation(b, c, z), turn * orientation(c, a, z)});
    if (side != 0) return side > 0;
  }
  return true;
}

double Region::signed_distance(Vec2 z) const {
  const double distance = std::sqrt(tree_.squared_distance(z));
  return contains(z) ? distance : -distance;
}

}  // namespace applique
