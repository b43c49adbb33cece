#include "applique/region/geodesic.h"

#include <algorithm>
#include <limits>
#include <map>

#include "applique/base/error.h"
#include "applique/base/predicates.h"
#include "applique/region/funnel.h"

namespace applique {
namespace {

double length_of(Vec2 a, Vec2 b, const std::vector<FunnelTurn>& turns) {
  double length = 0;
  for (const FunnelTurn& turn : turns) {
    length += std::abs(turn.at - a);
    a = turn.at;
  }
  return length + std::abs(b - a);
}

}  // namespace

InnerGeodesics::InnerGeodesics(const std::vector<Vec2>& polygon, const std::vector<Vec2>& points)
    : polygon_(polygon), points_(points) {
  cut_ears();
  link_triangles();
  for (const Vec2 z : points) homes_.push_back(triangle_of(z));
}

void InnerGeodesics::cut_ears() {
  const auto n = static_cast<std::uint32_t>(polygon_.size());
  std::vector<std::uint32_t> next(n), before(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    next[i] = (i + 1) % n;
    before[i] = (i + n - 1) % n;
  }
  const auto turn = [&](std::uint32_t i) {
    return orientation(polygon_[before[i]], polygon_[i], polygon_[next[i]]);
  };
  std::vector<std::uint32_t> blocking;  // Vertices that are not convex may lie in an ear.
  for (std::uint32_t i = 0; i < n; ++i) {
    if (turn(i) <= 0) blocking.push_back(i);
  }
  const auto is_ear = [&](std::uint32_t i) {
    if (turn(i) <= 0) return false;
    const Vec2 a = polygon_[before[i]], b = polygon_[i], c = polygon_[next[i]];
    const double left = std::min({a.real(), b.real(), c.real()}),
                 right = std::max({a.real(), b.real(), c.real()});
    const double bottom = std::min({a.imag(), b.imag(), c.imag()}),
                 top = std::max({a.imag(), b.imag(), c.imag()});
    return std::none_of(blocking.begin(), blocking.end(), [&](std::uint32_t k) {
      const Vec2 z = polygon_[k];
      if (z.real() < left || z.real() > right || z.imag() < bottom || z.imag() > top) return false;
      return k != before[i] && k != next[i] && k != i && orientation(a, b, z) >= 0 &&
             orientation(b, c, z) >= 0 && orientation(c, a, z) >= 0;
    });
  };
  std::uint32_t at = 0, since_ear = 0;
  for (std::uint32_t left = n; left > 3;) {
    if (!is_ear(at)) {
      APPLIQUE_ASSERT(++since_ear <= left);  // A simple polygon always has an ear.
      at = next[at];
      continue;
    }
    triangles_.push_back({{before[at], at, next[at]}, {-1, -1, -1}});
    next[before[at]] = next[at];
    before[next[at]] = before[at];
    std::erase_if(blocking, [&](std::uint32_t k) {
      return k == at || ((k == before[at] || k == next[at]) && turn(k) > 0);
    });
    since_ear = 0;
    --left;
    at = next[next[at]];  // Skipping one keeps the triangles from fanning about one vertex.
  }
  triangles_.push_back({{before[at], at, next[at]}, {-1, -1, -1}});
}

void InnerGeodesics::link_triangles() {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::int32_t, std::size_t>> open;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles_.size()); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[t].vertices[k], b = triangles_[t].vertices[(k + 1) % 3];
      const auto other = open.find({b, a});
      if (other == open.end()) {
        open[{a, b}] = {t, k};
      } else {
        triangles_[t].neighbours[k] = other->second.first;
        triangles_[other->second.first].neighbours[other->second.second] = t;
      }
    }
  }
}

// The first triangle that holds z, or the one that it misses by least.
std::int32_t InnerGeodesics::triangle_of(Vec2 z) const {
  std::int32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles_.size()); ++t) {
    double outside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = polygon_[triangles_[t].vertices[k]], b = polygon_[triangles_[t].vertices[(k + 1) % 3]];
      if (orientation(a, b, z) < 0) outside = std::max(outside, -cross(b - a, z - a) / std::abs(b - a));
    }
    if (outside < least) {
      least = outside;
      nearest = t;
      if (outside == 0) break;
    }
  }
  return nearest;
}

std::vector<double> InnerGeodesics::lengths(std::size_t source) const {
  const std::int32_t start = homes_[source];
  std::vector<std::int32_t> parent(triangles_.size(), -1);
  std::vector<std::int32_t> order = {start};
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (const std::int32_t t : triangles_[order[i]].neighbours) {
      if (t < 0 || t == parent[order[i]]) continue;
      parent[t] = order[i];
      order.push_back(t);
    }
  }
  std::vector<double> result;
  for (std::size_t target = 0; target < points_.size(); ++target) {
    std::vector<Portal> portals;
    for (std::int32_t t = homes_[target]; t != start; t = parent[t]) {
      const auto& neighbours = triangles_[t].neighbours;
      const auto k = static_cast<std::size_t>(std::find(neighbours.begin(), neighbours.end(), parent[t]) -
                                              neighbours.begin());
      // Walking into t: the edge as seen from inside t, counter-clockwise, has its start on the walker's
      // left.
      portals.push_back({polygon_[triangles_[t].vertices[k]], polygon_[triangles_[t].vertices[(k + 1) % 3]]});
    }
    std::reverse(portals.begin(), portals.end());
    result.push_back(
        length_of(points_[source], points_[target], pull_tight(points_[source], points_[target], portals)));
  }
  return result;
}

}  // namespace applique
