#include "applique/region/feature_graph.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>

#include "applique/base/predicates.h"
#include "applique/region/geodesic.h"

namespace applique {
namespace {

// From here on far partners weigh nothing beside near ones (§3.4 of the design).
constexpr std::size_t many_features = 32;
constexpr std::size_t nearest_partners = 12;

/// A symmetric relation between n features.
class Relation {
 public:
  explicit Relation(std::size_t n) : n_(n), bits_(n * n, 0) {}
  [[nodiscard]] bool has(std::uint32_t i, std::uint32_t j) const { return bits_[i * n_ + j] != 0; }
  void set(FeaturePair pair, bool value = true) {
    bits_[pair[0] * n_ + pair[1]] = bits_[pair[1] * n_ + pair[0]] = value ? 1 : 0;
  }
  [[nodiscard]] std::vector<FeaturePair> pairs() const {
    std::vector<FeaturePair> result;
    for (std::uint32_t i = 0; i < n_; ++i) {
      for (std::uint32_t j = i + 1; j < n_; ++j) {
        if (has(i, j)) result.push_back({i, j});
      }
    }
    return result;
  }

 private:
  std::size_t n_;
  std::vector<char> bits_;
};

/// A pair and how long it is. Ordered by length, then by place: never by number, so that renumbering the
/// features changes nothing.
struct Link {
  FeaturePair pair;
  double length;
  std::array<double, 4> place;
  bool operator<(const Link& other) const {
    return std::tie(length, place) < std::tie(other.length, other.place);
  }
};

Link make_link(const std::vector<Vec2>& features, std::uint32_t i, std::uint32_t j, double length) {
  std::array<double, 2> a = {features[i].real(), features[i].imag()};
  std::array<double, 2> b = {features[j].real(), features[j].imag()};
  if (b < a) std::swap(a, b);
  return {{std::min(i, j), std::max(i, j)}, length, {a[0], a[1], b[0], b[1]}};
}

/// The components of a growing graph.
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n), count_(n) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool join(FeaturePair pair) {
    const std::uint32_t a = of(pair[0]), b = of(pair[1]);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
    return true;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<std::uint32_t> parent_;
  std::size_t count_;
};

bool crosses(const std::vector<Vec2>& f, FeaturePair p, FeaturePair q) {
  const Vec2 a = f[p[0]], b = f[p[1]], c = f[q[0]], d = f[q[1]];
  return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

bool passes_a_feature(const std::vector<Vec2>& f, FeaturePair p) {
  const Vec2 a = f[p[0]], b = f[p[1]];
  for (std::uint32_t k = 0; k < f.size(); ++k) {
    if (k != p[0] && k != p[1] && dot(f[k] - a, f[k] - b) < 0 && orientation(a, b, f[k]) == 0) return true;
  }
  return false;
}

/// The third corner of the face of `planar` left of the edge from a to b, when that face is a triangle.
std::optional<std::uint32_t> left_apex(const std::vector<Vec2>& f, const Relation& planar, std::uint32_t a,
                                       std::uint32_t b) {
  for (std::uint32_t c = 0; c < f.size(); ++c) {
    if (!planar.has(a, c) || !planar.has(b, c) || orientation(f[a], f[b], f[c]) <= 0) continue;
    bool empty = true;
    for (std::uint32_t k = 0; k < f.size() && empty; ++k) {
      empty = k == a || k == b || k == c || orientation(f[a], f[b], f[k]) < 0 ||
              orientation(f[b], f[c], f[k]) < 0 || orientation(f[c], f[a], f[k]) < 0;
    }
    if (empty) return c;
  }
  return std::nullopt;
}

/// Shortest segments first, as long as they cross none before (§4.1 of the paper).
Relation greedy_planar(const std::vector<Vec2>& features, const std::vector<Link>& visible) {
  Relation planar(features.size());
  std::vector<FeaturePair> chosen;
  for (const Link& link : visible) {
    if (passes_a_feature(features, link.pair) ||
        std::any_of(chosen.begin(), chosen.end(),
                    [&](FeaturePair other) { return crosses(features, link.pair, other); })) {
      continue;
    }
    chosen.push_back(link.pair);
    planar.set(link.pair);
  }
  return planar;
}

/// Lawson's flips. The two triangles at an edge lie in the region, so the other diagonal of their
/// quadrilateral, when that is strictly convex, is visible too. Ends: each flip makes the triangulation more
/// Delaunay.
void flip_to_delaunay(const std::vector<Vec2>& f, Relation& planar) {
  for (bool flipped = true; flipped;) {
    flipped = false;
    std::vector<Link> edges;
    for (const FeaturePair pair : planar.pairs()) {
      edges.push_back(make_link(f, pair[0], pair[1], std::norm(f[pair[0]] - f[pair[1]])));
    }
    std::sort(edges.begin(), edges.end());
    for (const Link& edge : edges) {
      const auto [a, b] = edge.pair;
      const auto left = left_apex(f, planar, a, b), right = left_apex(f, planar, b, a);
      if (!left || !right || !crosses(f, {a, b}, {*left, *right})) continue;
      if (in_circle(f[a], f[b], f[*left], f[*right]) <= 0) continue;
      planar.set(edge.pair, false);
      planar.set({*left, *right});
      flipped = true;
    }
  }
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<Vec2>& features,
                                                       const Relation& planar) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const FeaturePair pair : planar.pairs()) {
    for (const auto& [a, b] : {pair, FeaturePair{pair[1], pair[0]}}) {
      const auto c = left_apex(features, planar, a, b);
      if (!c || *c < std::max(a, b)) continue;  // Found from its other edges, too: once is enough.
      triangles.push_back(a < b ? std::array{a, b, *c} : std::array{b, *c, a});
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/// Joins what `components` leaves apart by the shortest ways inside the region.
std::vector<Link> join_by_geodesics(const Region& region, const std::vector<Vec2>& features,
                                    Components& components) {
  const InnerGeodesics geodesics(region.polygon(), features);
  std::vector<Link> links;
  for (std::uint32_t i = 0; i + 1 < features.size(); ++i) {
    const std::vector<double> lengths = geodesics.lengths(i);
    for (std::uint32_t j = i + 1; j < features.size(); ++j) {
      if (components.of(i) != components.of(j))
        links.push_back(make_link(features, i, j, lengths[j] * lengths[j]));
    }
  }
  std::sort(links.begin(), links.end());
  std::vector<Link> chosen;
  for (const Link& link : links) {
    if (components.join(link.pair)) chosen.push_back(link);
  }
  return chosen;
}

/// For each feature its nearest visible partners.
Relation nearest_visible(std::size_t n, const std::vector<Link>& visible) {
  Relation kept(n);
  std::vector<std::size_t> partners(n, 0);
  for (const Link& link : visible) {  // Shortest first.
    const auto [i, j] = link.pair;
    if (partners[i] < nearest_partners || partners[j] < nearest_partners) kept.set(link.pair);
    ++partners[i];
    ++partners[j];
  }
  return kept;
}

}  // namespace

FeatureGraph build_feature_graph(const Region& region, const std::vector<Vec2>& features) {
  const auto n = static_cast<std::uint32_t>(features.size());
  std::vector<Link> visible;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) {
      if (region.contains_segment(features[i], features[j])) {
        visible.push_back(make_link(features, i, j, std::norm(features[i] - features[j])));
      }
    }
  }
  std::sort(visible.begin(), visible.end());

  FeatureGraph graph;
  Relation planar = greedy_planar(features, visible);
  flip_to_delaunay(features, planar);
  graph.planar = planar.pairs();
  graph.triangles = triangles_of(features, planar);

  Components components(n);
  for (const Link& link : visible) {
    if (components.join(link.pair)) graph.tree.push_back(link.pair);
  }
  if (components.count() > 1) {
    for (const Link& link : join_by_geodesics(region, features, components)) {
      graph.artificial.push_back(link.pair);
      graph.tree.push_back(link.pair);
    }
  }
  std::sort(graph.artificial.begin(), graph.artificial.end());

  Relation kept(n);
  if (n > many_features) {
    kept = nearest_visible(n, visible);
    for (const FeaturePair pair : graph.planar) kept.set(pair);
    for (const FeaturePair pair : graph.tree) {
      if (!std::binary_search(graph.artificial.begin(), graph.artificial.end(), pair)) kept.set(pair);
    }
  } else {
    for (const Link& link : visible) kept.set(link.pair);
  }
  graph.visible = kept.pairs();
  std::sort(graph.tree.begin(), graph.tree.end());
  return graph;
}

}  // namespace applique
