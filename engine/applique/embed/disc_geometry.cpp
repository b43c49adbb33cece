#include "applique/embed/disc_geometry.h"

#include <algorithm>
#include <cmath>

#include "applique/base/predicates.h"

namespace applique {
namespace {

/// Twice the slack of a triangle relative to its mean edge below which it counts as degenerate.
constexpr double mollification = 1e-6;

/// Heron's formula in Kahan's stable order.
double triangle_area(std::array<double, 3> l) {
  std::sort(l.begin(), l.end(), std::greater<>());
  const auto [a, b, c] = l;
  return 0.25 * std::sqrt(std::max(0.0, (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))));
}

void mollify(std::vector<std::array<double, 3>>& lengths) {
  double sum = 0, missing = 0;
  for (const auto& l : lengths) sum += l[0] + l[1] + l[2];
  const double slack = mollification * sum / static_cast<double>(3 * lengths.size());
  for (const auto& l : lengths)
    for (int k = 0; k < 3; ++k) missing = std::max(missing, l[k] + slack - l[(k + 1) % 3] - l[(k + 2) % 3]);
  if (missing <= 0) return;
  for (auto& l : lengths)
    for (double& length : l) length += missing;
}

std::vector<int> boundary_loop(const ImmersedDisc& disc) {
  std::vector<int> next(disc.vertex_count(), -1);
  int start = -1;
  for (const PatchFace& face : disc.faces())
    for (int k = 0; k < 3; ++k) {
      if (face.neighbours[k].valid()) continue;
      start = static_cast<int>(face.vertices[(k + 1) % 3].value);
      next[start] = static_cast<int>(face.vertices[(k + 2) % 3].value);
    }
  std::vector<int> loop;
  int v = start;
  do {
    loop.push_back(v);
    v = next[v];
  } while (v != start);
  return loop;
}

}  // namespace

std::array<Vec2, 3> DiscGeometry::flat(std::size_t t) const {
  const auto& l = lengths[t];
  return {Vec2(0), Vec2(l[2]), std::polar(l[1], angle(t, 0))};
}

double DiscGeometry::angle(std::size_t t, int k) const {
  return std::atan2(1.0, cotangents[t][k]);
}

DiscGeometry measure_disc(const ImmersedDisc& disc) {
  DiscGeometry geometry;
  geometry.vertices = disc.vertex_count();
  geometry.faces.reserve(disc.faces().size());
  geometry.lengths.reserve(disc.faces().size());
  for (const PatchFace& face : disc.faces()) {
    const auto& v = face.vertices;
    geometry.faces.push_back(
        {static_cast<int>(v[0].value), static_cast<int>(v[1].value), static_cast<int>(v[2].value)});
    geometry.lengths.push_back({(disc.position(v[2]) - disc.position(v[1])).norm(),
                                (disc.position(v[0]) - disc.position(v[2])).norm(),
                                (disc.position(v[1]) - disc.position(v[0])).norm()});
  }
  mollify(geometry.lengths);
  geometry.cotangents.reserve(geometry.faces.size());
  for (const auto& l : geometry.lengths) {
    const double area = triangle_area(l);
    geometry.area += area;
    std::array<double, 3> cotangents;
    for (int k = 0; k < 3; ++k) {
      const double a = l[k], b = l[(k + 1) % 3], c = l[(k + 2) % 3];
      cotangents[k] = (b * b + c * c - a * a) / (4 * area);
    }
    geometry.cotangents.push_back(cotangents);
  }
  geometry.boundary = boundary_loop(disc);
  return geometry;
}

std::size_t count_flips(const DiscGeometry& disc, const std::vector<Vec2>& plane) {
  return static_cast<std::size_t>(std::count_if(disc.faces.begin(), disc.faces.end(), [&](const auto& f) {
    return orientation(plane[f[0]], plane[f[1]], plane[f[2]]) <= 0;
  }));
}

}  // namespace applique
