#include "support/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace applique::shapes {

Soup grid(int columns, int rows, const std::function<Vec3(double, double)>& point) {
  Soup soup;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) soup.positions.push_back(point(double(i) / columns, double(j) / rows));
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if ((i + j) % 2 == 0) {
        soup.triangles.push_back({a, b, c});
        soup.triangles.push_back({a, c, d});
      } else {
        soup.triangles.push_back({a, b, d});
        soup.triangles.push_back({b, c, d});
      }
    }
  return soup;
}

Soup plane(int columns, int rows, double width, double height, double jitter, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-jitter, jitter);
  return grid(columns, rows, [&](double s, double t) {
    const bool inside = s > 0 && s < 1 && t > 0 && t < 1;
    return Vec3((s + (inside ? shift(random) / columns : 0)) * width,
                (t + (inside ? shift(random) / rows : 0)) * height, 0);
  });
}

Soup cylinder(int around, int along, double radius, double height) {
  return grid(around, along, [&](double s, double t) {
    const double angle = 2 * std::numbers::pi * (s == 1 ? 0 : s);
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), t * height);
  });
}

Soup sphere(int levels, double radius) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Soup soup;
  soup.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  soup.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto half = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middle.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(soup.positions.size()));
      if (is_new) soup.positions.push_back(soup.positions[a] + soup.positions[b]);
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : soup.triangles) {
      const std::uint32_t ab = half(a, b), bc = half(b, c), ca = half(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    soup.triangles = std::move(finer);
    for (Vec3& p : soup.positions) p.normalize();
  }
  for (Vec3& p : soup.positions) p = radius * p.normalized();
  return soup;
}

Soup torus(int around, int across, double major, double minor) {
  return grid(around, across, [&](double s, double t) {
    const double u = 2 * std::numbers::pi * (s == 1 ? 0 : s), v = 2 * std::numbers::pi * (t == 1 ? 0 : t);
    const double r = major + minor * std::cos(v);
    return Vec3(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
  });
}

Soup bump(int cells, double height, double width) {
  return grid(cells, cells, [&](double s, double t) {
    const double x = 2 * s - 1, y = 2 * t - 1;
    return Vec3(x, y, height * std::exp(-(x * x + y * y) / (width * width)));
  });
}

Vec3 hills_at(double x, double y) {
  return {x, y, 0.12 * std::sin(4 * x + 1) * std::cos(5 * y) + 0.03 * std::sin(13 * x - 7 * y)};
}

Soup sponge(int level, int parts) {
  int side = 1;
  for (int k = 0; k < level; ++k) side *= 3;
  const auto solid = [&](std::array<int, 3> cell) {
    for (const int at : cell)
      if (at < 0 || at >= side) return false;
    for (int scale = side; scale > 1; scale /= 3)
      if (std::count_if(cell.begin(), cell.end(), [&](int at) { return at / (scale / 3) % 3 == 1; }) > 1)
        return false;
    return true;
  };
  Soup soup;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto corner = [&](const std::array<int, 3>& at) {
    const auto [entry, is_new] = known.try_emplace(at, static_cast<std::uint32_t>(soup.positions.size()));
    if (is_new) soup.positions.push_back(Vec3(at[0], at[1], at[2]) * (2.0 / side / parts) - Vec3(1, 1, 1));
    return entry->second;
  };
  const auto add_square = [&](std::array<int, 3> at, int axis, bool up) {
    std::array<std::uint32_t, 4> v = {};
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    v[0] = corner(at);
    ++at[u];
    v[1] = corner(at);
    ++at[w];
    v[2] = corner(at);
    --at[u];
    v[3] = corner(at);
    if (!up) std::swap(v[1], v[3]);
    soup.triangles.push_back({v[0], v[1], v[2]});
    soup.triangles.push_back({v[0], v[2], v[3]});
  };
  for (int i = 0; i < side * side * side; ++i) {
    const std::array<int, 3> cell = {i % side, i / side % side, i / side / side};
    if (!solid(cell)) continue;
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, out = face % 2;
      std::array<int, 3> beyond = cell;
      beyond[axis] += 2 * out - 1;
      if (solid(beyond)) continue;
      for (int j = 0; j < parts * parts; ++j) {
        std::array<int, 3> at = {cell[0] * parts, cell[1] * parts, cell[2] * parts};
        at[axis] += out * parts;
        at[(axis + 1) % 3] += j % parts;
        at[(axis + 2) % 3] += j / parts;
        add_square(at, axis, out == 1);
      }
    }
  }
  return soup;
}

Soup hills(int cells) {
  return grid(cells, cells, [](double s, double t) { return hills_at(2 * s - 1, 2 * t - 1); });
}

SurfacePoint nearest(const SurfaceMesh& mesh, const Vec3& position) {
  SurfacePoint best;
  double best_distance = std::numeric_limits<double>::infinity();
  for (FaceId f : ids<FaceId>(mesh.faces.size())) {
    const auto [a, b, c] = mesh.corners(f);
    // The plane's point in barycentrics; outside the face, its clamp to the nearest edge.
    const Vec3 e1 = b - a, e2 = c - a, d = position - a;
    const double d11 = e1.dot(e1), d12 = e1.dot(e2), d22 = e2.dot(e2), p1 = d.dot(e1), p2 = d.dot(e2);
    const double det = d11 * d22 - d12 * d12;
    std::vector<std::array<double, 3>> candidates;
    const double s = (d22 * p1 - d12 * p2) / det, t = (d11 * p2 - d12 * p1) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      candidates.push_back({1 - s - t, s, t});
    } else {
      const std::array<Vec3, 3> corner = {a, b, c};
      for (int k = 0; k < 3; ++k) {
        const Vec3 from = corner[k], edge = corner[(k + 1) % 3] - from;
        const double along = std::clamp((position - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
        std::array<double, 3> bary = {0, 0, 0};
        bary[k] = 1 - along;
        bary[(k + 1) % 3] = along;
        candidates.push_back(bary);
      }
    }
    for (const auto& bary : candidates) {
      const double distance = (position_of(mesh, {f, bary}) - position).norm();
      if (distance < best_distance) {
        best_distance = distance;
        best = {f, bary};
      }
    }
  }
  return best;
}

}  // namespace applique::shapes
