#include "applique/region/delaunay.h"

#include <algorithm>
#include <deque>

#include "applique/base/error.h"
#include "applique/base/predicates.h"

namespace applique {

DelaunayMesh::DelaunayMesh(Vec2 middle, double reach) {
  for (const Vec2 corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) {
    points_.push_back(middle + 2 * reach * corner);
    opposite_.push_back(-1);
  }
  const std::int32_t e = 3 * add_triangle(1, 2, 0, 0), f = 3 * add_triangle(3, 0, 2, 0);
  join(e, f, 0);
}

int DelaunayMesh::side(std::int32_t edge, Vec2 z) const {
  return orientation(at(from(edge)), at(to(edge)), z);
}

void DelaunayMesh::set_corner(std::int32_t edge, std::uint32_t point) {
  corner_[edge] = point;
  opposite_[point] = edge;
}

/// Makes two edges the two sides of one.
void DelaunayMesh::join(std::int32_t edge, std::int32_t twin, char fixed) {
  twin_[edge] = twin;
  fixed_[edge] = fixed;
  if (twin < 0) return;
  twin_[twin] = edge;
  fixed_[twin] = fixed;
}

std::int32_t DelaunayMesh::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, char inside) {
  const auto edge = static_cast<std::int32_t>(corner_.size());
  corner_.resize(corner_.size() + 3);
  twin_.resize(corner_.size(), -1);
  fixed_.resize(corner_.size(), 0);
  inside_.push_back(inside);
  set_corner(edge, a);
  set_corner(edge + 1, b);
  set_corner(edge + 2, c);
  return edge / 3;
}

/// Turns the edge from p to q with opposite corners a and b into the one from b to a. Afterwards `edge` runs
/// from p to b, its former twin from q to a.
void DelaunayMesh::flip(std::int32_t edge) {
  const std::int32_t twin = twin_[edge];
  const std::int32_t a_side = next(edge), b_side = next(twin);
  const std::int32_t beyond_a = twin_[a_side], beyond_b = twin_[b_side];
  const char fixed_a = fixed_[a_side], fixed_b = fixed_[b_side];
  const std::uint32_t p = corner_[a_side], q = corner_[b_side];
  set_corner(previous(edge), corner_[twin]);
  set_corner(previous(twin), corner_[edge]);
  set_corner(a_side, p);  // p and q have left a triangle each: their opposite edges are those that stay.
  set_corner(b_side, q);
  join(edge, beyond_b, fixed_b);
  join(twin, beyond_a, fixed_a);
  join(a_side, b_side, 0);
}

/// Joins a point to the three corners. Afterwards `edge` is opposite the point; the edges from its ends to
/// the point follow it.
void DelaunayMesh::split_triangle(std::int32_t edge, std::uint32_t point) {
  const std::uint32_t a = corner_[edge], b = from(edge), c = to(edge);
  const std::int32_t ca = next(edge), ab = previous(edge);
  const char inside = inside_[edge / 3];
  const std::int32_t over_ca = 3 * add_triangle(point, c, a, inside);
  const std::int32_t over_ab = 3 * add_triangle(point, a, b, inside);
  join(over_ca, twin_[ca], fixed_[ca]);
  join(over_ab, twin_[ab], fixed_[ab]);
  join(over_ca + 1, over_ab + 2, 0);
  join(ca, over_ca + 2, 0);
  join(ab, over_ab + 1, 0);
  set_corner(edge, point);
  set_corner(ca, b);
  set_corner(ab, c);
}

/// The triangle over the edge is split with one flat part, which a flip hands over to the other side.
void DelaunayMesh::split_edge(std::int32_t edge, std::uint32_t point) {
  const char fixed = fixed_[edge];
  const std::int32_t other = twin_[edge] / 3;
  split_triangle(edge, point);
  for (const std::int32_t half : {next(edge), previous(edge)}) join(half, twin_[half], fixed);
  flip(edge);
  inside_[edge / 3] = inside_[other];
}

/// The two triangles at the edge make a strictly convex quadrilateral.
bool DelaunayMesh::can_flip(std::int32_t edge) const {
  const Vec2 a = at(corner_[edge]), b = at(corner_[twin_[edge]]);
  return orientation(a, at(from(edge)), b) > 0 && orientation(b, at(to(edge)), a) > 0;
}

/// Lawson's flips, from the edges given on.
void DelaunayMesh::restore_delaunay(std::vector<std::int32_t> edges) {
  while (!edges.empty()) {
    const std::int32_t edge = edges.back(), twin = twin_[edge];
    edges.pop_back();
    if (twin < 0 || fixed_[edge]) continue;
    if (in_circle(at(corner_[edge]), at(from(edge)), at(to(edge)), at(corner_[twin])) <= 0) continue;
    flip(edge);
    edges.insert(edges.end(), {edge, previous(edge), twin, previous(twin)});
  }
}

void DelaunayMesh::restore_star(std::uint32_t point) {
  std::vector<std::int32_t> edges;
  visit_star(point, [&](std::int32_t edge) { edges.push_back(edge); });
  restore_delaunay(std::move(edges));
}

std::uint32_t DelaunayMesh::insert(Vec2 z) {
  std::int32_t triangle = opposite_.back() / 3;
  for (int k = 0; k < 3;) {  // Towards z over any edge that it is beyond: ends in a Delaunay triangulation.
    const std::int32_t edge = 3 * triangle + k++;
    if (side(edge, z) >= 0) continue;
    APPLIQUE_ASSERT(twin_[edge] >= 0);
    triangle = twin_[edge] / 3;
    k = 0;
  }
  for (int k = 0; k < 3; ++k) {
    if (at(corner_[3 * triangle + k]) == z) return corner_[3 * triangle + k];
  }
  return insert_into(triangle, z);
}

std::uint32_t DelaunayMesh::insert_into(std::int32_t triangle, Vec2 z) {
  const auto point = static_cast<std::uint32_t>(points_.size());
  std::int32_t on = -1;
  for (std::int32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
    if (side(edge, z) == 0) on = edge;
  }
  points_.push_back(z);
  opposite_.push_back(-1);
  if (on < 0) {
    split_triangle(3 * triangle, point);
  } else {
    split_edge(on, point);
  }
  restore_star(point);
  return point;
}

std::int32_t DelaunayMesh::edge_between(std::uint32_t a, std::uint32_t b) const {
  if (a < box_corners) {  // Nothing goes all round those.
    const std::int32_t edge = edge_between(b, a);
    return edge < 0 ? edge : twin_[edge];
  }
  std::int32_t found = -1;
  visit_star(a, [&](std::int32_t edge) {
    if (from(edge) == b) found = previous(edge);
  });
  return found;
}

void DelaunayMesh::set_fixed(std::int32_t edge) {
  fixed_[edge] = fixed_[twin_[edge]] = 1;
}

std::vector<std::uint32_t> DelaunayMesh::fix(std::uint32_t a, std::uint32_t b) {
  std::vector<std::uint32_t> chain = {a};
  while (a != b) {
    const Vec2 start = at(a), goal = at(b);
    std::uint32_t end = b;
    std::int32_t leaves_over = -1;
    bool is_edge = false;
    visit_star(a, [&](std::int32_t edge) {
      const int right = orientation(start, goal, at(from(edge))),
                left = orientation(start, goal, at(to(edge)));
      if (right == 0 && dot(at(from(edge)) - start, goal - start) > 0) {
        end = from(edge);
        is_edge = true;
      }
      if (right < 0 && left > 0) leaves_over = edge;
    });
    if (!is_edge) {
      std::vector<std::array<std::uint32_t, 2>> crossed;
      for (std::int32_t edge = leaves_over;;) {
        APPLIQUE_ASSERT(!fixed_[edge]);
        crossed.push_back({from(edge), to(edge)});
        const std::int32_t twin = twin_[edge];
        const int turn = orientation(start, goal, at(corner_[twin]));
        end = corner_[twin];
        if (turn == 0) break;
        edge = turn > 0 ? next(twin) : previous(twin);
      }
      clear_way(a, end, std::move(crossed));
    }
    set_fixed(edge_between(a, end));
    chain.push_back(end);
    a = end;
  }
  return chain;
}

/// Flips the crossed edges, those first whose quadrilateral is convex, until none crosses the line from a to
/// b (Sloan 1993, "A fast algorithm for generating constrained Delaunay triangulations").
void DelaunayMesh::clear_way(std::uint32_t a, std::uint32_t b,
                             std::vector<std::array<std::uint32_t, 2>> crossed) {
  std::deque<std::array<std::uint32_t, 2>> queue(crossed.begin(), crossed.end());
  std::vector<std::array<std::uint32_t, 2>> clear;
  while (!queue.empty()) {
    const auto ends = queue.front();
    queue.pop_front();
    const std::int32_t edge = edge_between(ends[0], ends[1]);
    if (!can_flip(edge)) {
      queue.push_back(ends);
      continue;
    }
    const std::uint32_t p = corner_[edge], q = corner_[twin_[edge]];
    flip(edge);
    const bool crosses = orientation(at(a), at(b), at(p)) * orientation(at(a), at(b), at(q)) < 0;
    (crosses ? queue.emplace_back() : clear.emplace_back()) = {p, q};
  }
  set_fixed(edge_between(a, b));
  for (const auto& [p, q] : clear) {
    if (const std::int32_t edge = edge_between(p, q); edge >= 0) restore_delaunay({edge});
  }
}

std::optional<std::uint32_t> DelaunayMesh::split_fixed(std::int32_t edge) {
  const std::uint32_t p = from(edge), q = to(edge);
  const Vec2 z = 0.5 * (at(p) + at(q));
  for (const std::int32_t half : {edge, twin_[edge]}) {
    if (side(next(half), z) <= 0 || side(previous(half), z) <= 0) return bend(half);
  }
  const auto point = static_cast<std::uint32_t>(points_.size());
  points_.push_back(z);
  opposite_.push_back(-1);
  middles_[std::minmax(p, q)] = point;
  split_edge(edge, point);
  restore_star(point);
  return point;
}

/// Leads a fixed edge over the opposite corner, which lies on it up to rounding. What is inside shrinks by
/// the triangle between where the edge bounds it; must not come apart there.
std::optional<std::uint32_t> DelaunayMesh::bend(std::int32_t edge) {
  const std::uint32_t a = from(edge), b = to(edge), point = corner_[edge];
  if (dot(at(a) - at(point), at(b) - at(point)) >= 0) return std::nullopt;
  if (inside_[edge / 3] != inside_[twin_[edge] / 3]) {
    bool within = true;
    visit_star(point, [&](std::int32_t opposite) { within &= inside(opposite / 3); });
    if (!within) return std::nullopt;
    inside_[edge / 3] = 0;
  }
  set_fixed(next(edge));
  set_fixed(previous(edge));
  join(edge, twin_[edge], 0);
  middles_[std::minmax(a, b)] = point;
  restore_delaunay({edge});
  return point;
}

std::vector<std::uint32_t> DelaunayMesh::pieces(std::uint32_t a, std::uint32_t b) const {
  std::vector<std::uint32_t> open = {b}, chain = {a};
  while (!open.empty()) {
    const auto middle = middles_.find(std::minmax(chain.back(), open.back()));
    if (middle != middles_.end()) {
      open.push_back(middle->second);
      continue;
    }
    chain.push_back(open.back());
    open.pop_back();
  }
  return chain;
}

void DelaunayMesh::mark_inside() {
  std::fill(inside_.begin(), inside_.end(), char{1});
  std::vector<std::int32_t> open = {opposite_[0] / 3};
  inside_[open[0]] = 0;
  while (!open.empty()) {
    const std::int32_t triangle = open.back();
    open.pop_back();
    for (std::int32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
      if (twin_[edge] < 0 || fixed_[edge] || !inside_[twin_[edge] / 3]) continue;
      inside_[twin_[edge] / 3] = 0;
      open.push_back(twin_[edge] / 3);
    }
  }
}

DelaunayMesh::Walk DelaunayMesh::walk(std::int32_t triangle, Vec2 z) const {
  const std::int32_t first = 3 * triangle;
  const Vec2 start = (at(corner_[first]) + at(corner_[first + 1]) + at(corner_[first + 2])) / 3.0;
  std::int32_t exit = -1;
  for (std::int32_t edge = first; edge < first + 3; ++edge) {
    if (side(edge, z) >= 0) continue;
    const bool straddles =
        orientation(start, z, at(from(edge))) <= 0 && orientation(start, z, at(to(edge))) >= 0;
    if (exit < 0 || straddles) exit = edge;
  }
  if (exit < 0) return {.triangle = triangle};
  while (!fixed_[exit]) {
    const std::int32_t entry = twin_[exit];
    if (entry < 0) return {};
    exit = orientation(start, z, at(corner_[entry])) > 0 ? next(entry) : previous(entry);
    if (side(exit, z) >= 0) return {.triangle = exit / 3};
  }
  return {.wall = exit};
}

std::int32_t DelaunayMesh::encroached_by(Vec2 z, std::int32_t triangle) const {
  std::vector<std::int32_t> border = {3 * triangle, 3 * triangle + 1, 3 * triangle + 2};
  while (!border.empty()) {
    const std::int32_t edge = border.back(), twin = twin_[edge];
    border.pop_back();
    if (fixed_[edge]) {
      if (dot(at(from(edge)) - z, at(to(edge)) - z) < 0) return edge;
    } else if (twin >= 0 && in_circle(at(corner_[twin]), at(from(twin)), at(to(twin)), z) > 0) {
      border.insert(border.end(), {next(twin), previous(twin)});
    }
  }
  return -1;
}

}  // namespace applique
