#include "applique/paper/image_triangulation.h"

#include <algorithm>
#include <map>

#include "applique/base/error.h"
#include "applique/base/predicates.h"

namespace applique {
namespace {

constexpr std::uint32_t none = ImageTriangulation::none;
constexpr double on_edge = 1e-12;  // plane units

class Builder {
 public:
  explicit Builder(std::vector<Vec2> contour) { t_.points = std::move(contour); }

  ImageTriangulation build(const std::vector<Vec2>& features, double longest) {
    cut_ears();
    link();
    for (Vec2 z : features) t_.features.push_back(insert(z));
    flip_all();
    // By halves, and Delaunay again in between, for bisection alone keeps what slivers there are.
    double length = 0;
    for (std::uint32_t t = 0; t < t_.triangles.size(); ++t)
      length = std::max(length, edge_length(t, longest_of(t)));
    while (length > longest) {
      length = std::max(0.5 * length, longest);
      for (std::uint32_t t = 0; t < t_.triangles.size(); ++t)
        while (edge_length(t, longest_of(t)) > length) bisect(t);
      if (length > longest) flip_all();
    }
    return std::move(t_);
  }

 private:
  [[nodiscard]] Vec2 at(std::uint32_t t, int k) const { return t_.points[t_.triangles[t][k % 3]]; }
  [[nodiscard]] double edge_length(std::uint32_t t, int k) const {
    return std::abs(at(t, k + 1) - at(t, k + 2));
  }
  [[nodiscard]] int longest_of(std::uint32_t t) const {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (edge_length(t, k) > edge_length(t, longest)) longest = k;
    return longest;
  }
  [[nodiscard]] int edge_to(std::uint32_t t, std::uint32_t other) const {
    const auto& n = t_.neighbours[t];
    return static_cast<int>(std::find(n.begin(), n.end(), other) - n.begin());
  }

  void cut_ears() {
    std::vector<std::uint32_t> rim;
    for (std::uint32_t i = 0; i < t_.points.size(); ++i) rim.push_back(i);
    const auto is_ear = [&](std::size_t i) {
      const std::size_t n = rim.size();
      const Vec2 a = t_.points[rim[(i + n - 1) % n]], b = t_.points[rim[i]], c = t_.points[rim[(i + 1) % n]];
      if (orientation(a, b, c) <= 0) return false;
      return std::none_of(rim.begin(), rim.end(), [&](std::uint32_t v) {
        const Vec2 z = t_.points[v];
        return z != a && z != b && z != c && orientation(a, b, z) >= 0 && orientation(b, c, z) >= 0 &&
               orientation(c, a, z) >= 0;
      });
    };
    std::size_t i = 0, tried = 0;
    while (rim.size() > 3) {
      APPLIQUE_ASSERT(tried++ <= rim.size());
      if (is_ear(i)) {
        const std::size_t n = rim.size();
        t_.triangles.push_back({rim[(i + n - 1) % n], rim[i], rim[(i + 1) % n]});
        rim.erase(rim.begin() + static_cast<std::ptrdiff_t>(i));
        tried = 0;
      }
      i = (i + 1) % rim.size();
    }
    t_.triangles.push_back({rim[0], rim[1], rim[2]});
  }

  void link() {
    std::map<std::array<std::uint32_t, 2>, std::array<std::uint32_t, 2>> sides;
    t_.neighbours.assign(t_.triangles.size(), {none, none, none});
    for (std::uint32_t t = 0; t < t_.triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t_.triangles[t][(k + 1) % 3], b = t_.triangles[t][(k + 2) % 3];
        if (const auto found = sides.find({b, a}); found != sides.end()) {
          t_.neighbours[t][k] = found->second[0];
          t_.neighbours[found->second[0]][found->second[1]] = t;
        }
        sides[{a, b}] = {t, k};
      }
  }

  void relink(std::uint32_t t, std::uint32_t from, std::uint32_t to) {
    if (t != none) std::replace(t_.neighbours[t].begin(), t_.neighbours[t].end(), from, to);
  }

  /// Splits edge k of t, and the triangle across, at point v.
  void split_edge(std::uint32_t t, int k, std::uint32_t v) {
    const std::uint32_t across = t_.neighbours[t][k];
    const std::uint32_t half = split_side(t, k, v);
    if (across == none) return;
    const int back = edge_to(across, t);
    const std::uint32_t other = split_side(across, back, v);
    // t keeps the edge's first end, `half` its second; across the edge it is the other way round.
    t_.neighbours[t][k] = other;
    t_.neighbours[half][k] = across;
    t_.neighbours[across][back] = half;
    t_.neighbours[other][back] = t;
  }

  /// t keeps the part at corner k + 1; the new triangle, whose number is returned, has that at k + 2.
  std::uint32_t split_side(std::uint32_t t, int k, std::uint32_t v) {
    const auto half = static_cast<std::uint32_t>(t_.triangles.size());
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    auto corners = t_.triangles[t];
    auto sides = t_.neighbours[t];
    corners[a] = v;
    sides[b] = t;
    sides[k] = none;
    relink(t_.neighbours[t][a], t, half);
    t_.triangles.push_back(corners);
    t_.neighbours.push_back(sides);
    t_.triangles[t][b] = v;
    t_.neighbours[t][a] = half;
    return half;
  }

  std::uint32_t insert(Vec2 z) {
    for (std::uint32_t v = 0; v < t_.points.size(); ++v)
      if (t_.points[v] == z) return v;
    // The triangle that z is deepest in: a feature on a slanted edge may lie outside by rounding.
    std::uint32_t home = 0;
    double depth = -1;
    for (std::uint32_t t = 0; t < t_.triangles.size(); ++t) {
      double least = 1;
      for (int k = 0; k < 3; ++k)
        least = std::min(least, cross(at(t, k + 2) - at(t, k + 1), z - at(t, k + 1)) / edge_length(t, k));
      if (least <= depth && t > 0) continue;
      depth = least;
      home = t;
    }
    const auto v = static_cast<std::uint32_t>(t_.points.size());
    t_.points.push_back(z);
    for (int k = 0; k < 3; ++k)
      if (cross(at(home, k + 2) - at(home, k + 1), z - at(home, k + 1)) < on_edge * edge_length(home, k)) {
        split_edge(home, k, v);
        return v;
      }
    // Three triangles round z.
    const auto [a, b, c] = t_.triangles[home];
    const auto [na, nb, nc] = t_.neighbours[home];
    const auto first = static_cast<std::uint32_t>(t_.triangles.size()), second = first + 1;
    t_.triangles[home] = {v, b, c};
    t_.neighbours[home] = {na, first, second};
    t_.triangles.push_back({v, c, a});
    t_.neighbours.push_back({nb, second, home});
    t_.triangles.push_back({v, a, b});
    t_.neighbours.push_back({nc, home, first});
    relink(nb, home, first);
    relink(nc, home, second);
    return v;
  }

  void flip_all() {
    for (bool flipped = true; flipped;) {
      flipped = false;
      for (std::uint32_t t = 0; t < t_.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
          if (t_.neighbours[t][k] != none) flipped = flip_if_better(t, k) || flipped;
    }
  }

  bool flip_if_better(std::uint32_t t, int k) {
    const std::uint32_t other = t_.neighbours[t][k];
    const int back = edge_to(other, t);
    const Vec2 a = at(t, k), b = at(t, k + 1), c = at(t, k + 2), d = at(other, back);
    if (in_circle(a, b, c, d) <= 0 || orientation(a, b, d) <= 0 || orientation(d, c, a) <= 0) return false;
    const std::uint32_t va = t_.triangles[t][k], vb = t_.triangles[t][(k + 1) % 3],
                        vc = t_.triangles[t][(k + 2) % 3], vd = t_.triangles[other][back];
    const std::uint32_t ab = t_.neighbours[t][(k + 2) % 3], ca = t_.neighbours[t][(k + 1) % 3],
                        bd = t_.neighbours[other][(back + 1) % 3], dc = t_.neighbours[other][(back + 2) % 3];
    t_.triangles[t] = {va, vb, vd};
    t_.neighbours[t] = {bd, other, ab};
    t_.triangles[other] = {va, vd, vc};
    t_.neighbours[other] = {dc, ca, t};
    relink(bd, other, t);
    relink(ca, t, other);
    return true;
  }

  /// Bisects the longest edge of t, after those of its neighbours that are longer (Rivara 1984).
  void bisect(std::uint32_t t) {
    const int k = longest_of(t);
    while (true) {
      const std::uint32_t across = t_.neighbours[t][k];
      if (across == none || edge_length(across, longest_of(across)) <= edge_length(t, k)) break;
      bisect(across);
    }
    const auto v = static_cast<std::uint32_t>(t_.points.size());
    t_.points.push_back(0.5 * (at(t, k + 1) + at(t, k + 2)));
    split_edge(t, k, v);
  }

  ImageTriangulation t_;
};

}  // namespace

ImageTriangulation triangulate_image(const Region& region, const std::vector<Vec2>& features,
                                     double longest_edge) {
  return Builder(region.polygon()).build(features, longest_edge);
}

}  // namespace applique
