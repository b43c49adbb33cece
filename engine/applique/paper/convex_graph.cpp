#include "applique/paper/convex_graph.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

#include "applique/base/error.h"
#include "applique/base/predicates.h"

namespace applique {
namespace {

using Polygon = std::vector<std::uint32_t>;         // features, counter-clockwise
using DirectedEdge = std::array<std::uint32_t, 2>;  // from, to

FeaturePair sorted_pair(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The outlines of what the triangles cover: what is left of their edges when the inner ones are deleted.
std::vector<Polygon> find_outlines(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::map<DirectedEdge, std::uint32_t> apexes;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) apexes[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
  const auto on_outline = [&](DirectedEdge edge) { return !apexes.contains({edge[1], edge[0]}); };
  std::vector<Polygon> outlines;
  std::set<DirectedEdge> walked;
  for (const auto& [start, apex] : apexes) {
    if (!on_outline(start) || walked.contains(start)) continue;
    Polygon outline;
    DirectedEdge edge = start;
    do {
      walked.insert(edge);
      outline.push_back(edge[0]);
      // Turn round the edge's end within the triangles, so that outlines that touch there stay apart.
      DirectedEdge next = {edge[1], apexes.at(edge)};
      while (!on_outline(next)) next[1] = apexes.at({next[1], next[0]});
      edge = next;
    } while (edge != start);
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

/// Cuts one outline.
class Cutter {
 public:
  Cutter(const std::vector<Vec2>& features, const Polygon& outline) : f_(features), outline_(outline) {}

  std::vector<Polygon> convex_parts() {
    triangulate();
    drop_unneeded();
    return split(outline_);
  }

 private:
  /// Places in the outline; first < second.
  struct Diagonal {
    std::size_t i, j;
    bool operator==(const Diagonal&) const = default;
  };

  [[nodiscard]] std::size_t size() const { return outline_.size(); }
  [[nodiscard]] Vec2 at(std::size_t i) const { return f_[outline_[i % size()]]; }

  [[nodiscard]] static bool cross_properly(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
  }

  /// Whether the segment from corner i to corner j starts into the inside of the outline.
  [[nodiscard]] bool starts_inside(std::size_t i, std::size_t j) const {
    const Vec2 before = at(i + size() - 1), here = at(i), after = at(i + 1), goal = at(j);
    if (orientation(before, here, after) > 0)
      return orientation(here, goal, before) > 0 && orientation(goal, here, after) > 0;
    return orientation(here, goal, after) < 0 || orientation(goal, here, before) < 0;
  }

  [[nodiscard]] bool is_clear(std::size_t i, std::size_t j) const {
    if (!starts_inside(i, j)) return false;
    const Vec2 a = at(i), b = at(j);
    for (std::size_t k = 0; k < size(); ++k)
      if (cross_properly(a, b, at(k), at(k + 1))) return false;
    return std::none_of(f_.begin(), f_.end(), [&](Vec2 z) {
      return z != a && z != b && orientation(a, b, z) == 0 && dot(z - a, z - b) < 0;
    });
  }

  void triangulate() {
    std::vector<Diagonal> candidates;
    for (std::size_t i = 0; i < size(); ++i)
      for (std::size_t j = i + 2; j < size() - (i == 0 ? 1 : 0); ++j)
        if (is_clear(i, j)) candidates.push_back({i, j});
    // By length, then by place: the numbering of the features does not matter.
    const auto key = [&](const Diagonal& d) {
      const Vec2 a = at(d.i), b = at(d.j), middle = a + b;
      return std::tuple(std::norm(a - b), middle.real(), middle.imag());
    };
    std::sort(candidates.begin(), candidates.end(),
              [&](const Diagonal& a, const Diagonal& b) { return key(a) < key(b); });
    for (const Diagonal& candidate : candidates)
      if (std::none_of(diagonals_.begin(), diagonals_.end(), [&](const Diagonal& chosen) {
            return cross_properly(at(candidate.i), at(candidate.j), at(chosen.i), at(chosen.j));
          }))
        diagonals_.push_back(candidate);
  }

  void drop_unneeded() {
    for (std::size_t k = diagonals_.size(); k-- > 0;) {
      const Diagonal diagonal = diagonals_[k];
      if (stays_convex(diagonal.i, diagonal.j) && stays_convex(diagonal.j, diagonal.i))
        diagonals_.erase(diagonals_.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }

  /// Whether corner i keeps convex angles without its diagonal to corner j.
  [[nodiscard]] bool stays_convex(std::size_t i, std::size_t j) const {
    // The edges at i run, counter-clockwise, from the outline's next corner to its previous one.
    const auto turn_of = [&](std::size_t k) { return (k + size() - i) % size(); };
    std::size_t before = i + 1, after = i + size() - 1;
    for (const Diagonal& other : diagonals_) {
      if (other.i != i && other.j != i) continue;
      const std::size_t end = other.i == i ? other.j : other.i;
      if (turn_of(end) < turn_of(j) && turn_of(end) > turn_of(before)) before = end;
      if (turn_of(end) > turn_of(j) && turn_of(end) < turn_of(after)) after = end;
    }
    return orientation(at(i), at(before), at(after)) >= 0;
  }

  /// Splits a part of the outline along its diagonals.
  [[nodiscard]] std::vector<Polygon> split(const Polygon& part) const {
    for (const Diagonal& diagonal : diagonals_) {
      const auto first = std::find(part.begin(), part.end(), outline_[diagonal.i]);
      const auto second = std::find(part.begin(), part.end(), outline_[diagonal.j]);
      if (first == part.end() || second == part.end()) continue;
      const auto [low, high] = std::minmax(first, second);
      if (high - low < 2 || (low == part.begin() && high == part.end() - 1)) continue;  // cut here already
      Polygon inner(low, high + 1), outer(part.begin(), low + 1);
      outer.insert(outer.end(), high, part.end());
      std::vector<Polygon> parts = split(inner);
      for (Polygon& other : split(outer)) parts.push_back(std::move(other));
      return parts;
    }
    return {part};
  }

  const std::vector<Vec2>& f_;
  const Polygon& outline_;
  std::vector<Diagonal> diagonals_;  // shortest first
};

bool lies_in(const std::vector<Vec2>& f, const Polygon& face, Vec2 z) {
  for (std::size_t i = 0; i < face.size(); ++i)
    if (orientation(f[face[i]], f[face[(i + 1) % face.size()]], z) < 0) return false;
  return true;
}

}  // namespace

ConvexGraph build_convex_graph(const std::vector<Vec2>& features, const FeatureGraph& graph) {
  ConvexGraph convex;
  for (const Polygon& outline : find_outlines(graph.triangles))
    for (Polygon& part : Cutter(features, outline).convex_parts()) convex.faces.push_back(std::move(part));

  std::set<FeaturePair> edges, in_triangles;
  for (const Polygon& face : convex.faces)
    for (std::size_t i = 0; i < face.size(); ++i)
      edges.insert(sorted_pair(face[i], face[(i + 1) % face.size()]));
  for (const auto& t : graph.triangles)
    for (int k = 0; k < 3; ++k) in_triangles.insert(sorted_pair(t[k], t[(k + 1) % 3]));
  for (const FeaturePair pair : graph.planar) {
    if (in_triangles.contains(pair)) continue;
    convex.bridges.push_back(pair);
    edges.insert(pair);
  }
  convex.edges.assign(edges.begin(), edges.end());

  std::vector<char> has_edge(features.size(), false);
  for (const auto& [i, j] : convex.edges) has_edge[i] = has_edge[j] = true;
  for (std::uint32_t k = 0; k < features.size(); ++k) {
    if (has_edge[k]) continue;
    const auto face = std::find_if(convex.faces.begin(), convex.faces.end(),
                                   [&](const Polygon& p) { return lies_in(features, p, features[k]); });
    if (face != convex.faces.end())
      convex.isolated.push_back({k, static_cast<std::uint32_t>(face - convex.faces.begin())});
  }
  return convex;
}

}  // namespace applique
