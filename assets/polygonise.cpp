#include "polygonise.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "parallel.h"

namespace applique::assets {
namespace {

/// The sampling grid: uniform in its own space, and bent around the focus so that cells there are finer.
class BentGrid {
 public:
  explicit BentGrid(const PolygoniseOptions& options) : options_(options) {
    // Grid space is the scene with distances from the focus stretched; its cells are `coarse` wide.
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      // Stretching is strongest nearest the focus, so that the box's sides bulge most there.
      low[axis] = to_grid(options.focus + (options.low[axis] - options.focus[axis]) * Vec3::Unit(axis))[axis];
      high[axis] =
          to_grid(options.focus + (options.high[axis] - options.focus[axis]) * Vec3::Unit(axis))[axis];
    }
    low_ = low.array() - 2 * options.coarse;
    for (int axis = 0; axis < 3; ++axis)
      size[axis] = static_cast<int>(std::ceil((high[axis] - low_[axis]) / options.coarse)) + 3;
  }

  [[nodiscard]] Vec3 point(const Vec3& index) const {
    const Vec3 q = low_ + options_.coarse * index;
    const double r = q.norm();
    if (r < 1e-12) return options_.focus;
    // Invert stretch() by bisection: it grows with r.
    double near = 0;
    double far = r;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (near + far);
      (stretch(middle) < r ? near : far) = middle;
    }
    return options_.focus + q * (near / r);
  }

  [[nodiscard]] std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * size[1] + y) * size[0] + x;
  }

  std::array<int, 3> size{};

 private:
  /// Distance from the focus in grid space: slope coarse/fine within the focus radius, easing to 1.
  [[nodiscard]] double stretch(double r) const {
    const double gain = options_.coarse / options_.fine - 1;
    const double excess = std::max(r - options_.focus_radius, 0.0);
    const double reach = options_.focus_radius;
    return r + gain * (std::min(r, options_.focus_radius) + reach * (1 - std::exp(-excess / reach)));
  }
  [[nodiscard]] Vec3 to_grid(const Vec3& p) const {
    const Vec3 d = p - options_.focus;
    const double r = d.norm();
    return r < 1e-12 ? d : Vec3(d * (stretch(r) / r));
  }

  PolygoniseOptions options_;
  Vec3 low_ = Vec3::Zero();
};

// A cell's corners are numbered by bits x, y, z; edge 4 * axis + i runs along `axis` from edge_start.
constexpr int edge_start[12] = {0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};

int edge_of(int corner_a, int corner_b) {
  const int bit = corner_a ^ corner_b;
  const int axis = bit == 1 ? 0 : bit == 2 ? 1 : 2;
  const int start = std::min(corner_a, corner_b);
  for (int i = 0; i < 4; ++i)
    if (edge_start[4 * axis + i] == start) return 4 * axis + i;
  return -1;
}

/// Which sheet of the surface each crossed edge of a cell belongs to (-1: not crossed), and how many there
/// are. On a face with four crossings the two inside corners are kept apart, from both sides alike.
int sheets_of(unsigned inside, std::array<int, 12>& sheet) {
  std::array<int, 12> parent;
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int e) {
    while (parent[e] != e) e = parent[e];
    return e;
  };
  const auto is_inside = [&](int corner) { return (inside >> corner & 1U) != 0; };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (axis + 1) % 3;
      const int v = 1 << (axis + 2) % 3;
      const int base = side << axis;
      const int ring[4] = {base, base | u, base | u | v, base | v};
      int crossed[4];
      int count = 0;
      for (int i = 0; i < 4; ++i)
        if (is_inside(ring[i]) != is_inside(ring[(i + 1) % 4])) crossed[count++] = i;
      if (count == 2)
        parent[root(edge_of(ring[crossed[0]], ring[(crossed[0] + 1) % 4]))] =
            root(edge_of(ring[crossed[1]], ring[(crossed[1] + 1) % 4]));
      if (count == 4)
        for (int i = 0; i < 4; ++i)
          if (is_inside(ring[i]))
            parent[root(edge_of(ring[i], ring[(i + 1) % 4]))] = root(edge_of(ring[i], ring[(i + 3) % 4]));
    }
  int count = 0;
  std::array<int, 12> number;
  number.fill(-1);
  for (int e = 0; e < 12; ++e) {
    const int a = edge_start[e];
    const int b = a | 1 << e / 4;
    sheet[e] = -1;
    if (is_inside(a) == is_inside(b)) continue;
    int& n = number[root(e)];
    if (n < 0) n = count++;
    sheet[e] = n;
  }
  return count;
}

std::vector<std::vector<std::uint32_t>> neighbours_of(
    std::size_t count, const std::vector<std::array<std::uint32_t, 4>>& quads) {
  std::vector<std::vector<std::uint32_t>> neighbours(count);
  for (const auto& quad : quads)
    for (int i = 0; i < 4; ++i) neighbours[quad[i]].push_back(quad[(i + 1) % 4]);
  return neighbours;
}

}  // namespace

Vec3 field_normal(const DistanceField& field, const Vec3& p) {
  // Differences along the diagonals of a tetrahedron.
  constexpr double step = 1e-4;
  static const Vec3 corners[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  Vec3 gradient = Vec3::Zero();
  for (const Vec3& corner : corners) gradient += field(p + step * corner) * corner;
  const double length = gradient.norm();
  return length > 0 ? Vec3(gradient / length) : Vec3::UnitY();
}

Vec3 project_to_surface(const DistanceField& field, Vec3 p, double tolerance) {
  for (int i = 0; i < 20; ++i) {
    const double distance = field(p);
    if (std::abs(distance) < tolerance) break;
    p -= 0.9 * distance * field_normal(field, p);
  }
  return p;
}

double openness(const DistanceField& field, const Vec3& p, const Vec3& normal, double reach) {
  double blocked = 0;
  double weight = 0.5;
  for (double away = reach; away > 0.02 * reach; away *= 0.5) {
    blocked += weight * std::clamp(1 - field(p + away * normal) / away, 0.0, 1.0);
    weight *= 0.75;
  }
  return std::clamp(1 - blocked, 0.0, 1.0);
}

Mesh polygonise(const DistanceField& field, const PolygoniseOptions& options) {
  const BentGrid grid(options);
  const int nx = grid.size[0];
  const int ny = grid.size[1];
  const int nz = grid.size[2];
  std::vector<Vec3> points(static_cast<std::size_t>(nx) * ny * nz);
  std::vector<double> values(points.size());
  parallel_for(nz, [&](int z) {
    for (int y = 0; y < ny; ++y)
      for (int x = 0, known = 0; x < nx; ++x) {
        const std::size_t i = grid.at(x, y, z);
        points[i] = grid.point(Vec3(x, y, z));
        // Far from the surface only the sign counts, and the next few points along the row share it.
        if (known-- > 0) {
          values[i] = values[i - 1];
        } else {
          values[i] = field(points[i]);
          known = static_cast<int>(0.5 * std::abs(values[i]) / options.coarse);
        }
      }
  });

  // One vertex per sheet and cell, at the mean of the sheet's edge crossings.
  Mesh mesh;
  std::vector<std::array<int, 12>> cell_sheets;
  std::vector<std::uint32_t> cell_vertex;
  std::vector<std::int32_t> cell_slot(points.size(), -1);
  for (int z = 0; z + 1 < nz; ++z)
    for (int y = 0; y + 1 < ny; ++y)
      for (int x = 0; x + 1 < nx; ++x) {
        unsigned inside = 0;
        for (int corner = 0; corner < 8; ++corner)
          if (values[grid.at(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2))] < 0)
            inside |= 1U << corner;
        if (inside == 0 || inside == 255) continue;
        std::array<int, 12> sheet;
        const int sheets = sheets_of(inside, sheet);
        cell_slot[grid.at(x, y, z)] = static_cast<std::int32_t>(cell_sheets.size());
        cell_sheets.push_back(sheet);
        cell_vertex.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        std::array<Vec3, 4> sum;
        std::array<int, 4> count{};
        sum.fill(Vec3::Zero());
        for (int e = 0; e < 12; ++e) {
          if (sheet[e] < 0) continue;
          const int a = edge_start[e];
          const int b = a | 1 << e / 4;
          const std::size_t ia = grid.at(x + (a & 1), y + (a >> 1 & 1), z + (a >> 2));
          const std::size_t ib = grid.at(x + (b & 1), y + (b >> 1 & 1), z + (b >> 2));
          const double t = values[ia] / (values[ia] - values[ib]);
          sum[sheet[e]] += points[ia] + t * (points[ib] - points[ia]);
          ++count[sheet[e]];
        }
        for (int s = 0; s < sheets; ++s) mesh.positions.emplace_back(sum[s] / count[s]);
      }

  // One quad around each crossed grid edge, from the four cells that share it.
  std::vector<std::array<std::uint32_t, 4>> quads;
  for (int z = 1; z + 1 < nz; ++z)
    for (int y = 1; y + 1 < ny; ++y)
      for (int x = 1; x + 1 < nx; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const std::array<int, 3> base{x, y, z};
          std::array<int, 3> tip = base;
          ++tip[axis];
          const bool inside = values[grid.at(x, y, z)] < 0;
          if (inside == (values[grid.at(tip[0], tip[1], tip[2])] < 0)) continue;
          const int u = (axis + 1) % 3;
          const int v = (axis + 2) % 3;
          constexpr int steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
          std::array<std::uint32_t, 4> quad;
          for (int i = 0; i < 4; ++i) {
            std::array<int, 3> cell = base;
            cell[u] -= steps[i][0];
            cell[v] -= steps[i][1];
            const int start = steps[i][0] << u | steps[i][1] << v;
            const std::int32_t slot = cell_slot[grid.at(cell[0], cell[1], cell[2])];
            quad[i] = cell_vertex[slot] + cell_sheets[slot][edge_of(start, start | 1 << axis)];
          }
          if (!inside) std::swap(quad[1], quad[3]);
          quads.push_back(quad);
        }

  const int vertices = static_cast<int>(mesh.positions.size());
  mesh.normals.resize(vertices);
  double tolerance = 1e-3 * options.fine;
  const auto settle = [&](int block) {
    for (int i = 256 * block; i < std::min(256 * (block + 1), vertices); ++i) {
      mesh.positions[i] = project_to_surface(field, mesh.positions[i], tolerance);
      mesh.normals[i] = field_normal(field, mesh.positions[i]);
    }
  };
  const int blocks = (vertices + 255) / 256;
  parallel_for(blocks, settle);
  const auto neighbours = neighbours_of(mesh.positions.size(), quads);
  for (int round = 0; round < options.smoothing; ++round) {
    std::vector<Vec3> moved(mesh.positions.size());
    for (int i = 0; i < vertices; ++i) {
      Vec3 mean = Vec3::Zero();
      for (const std::uint32_t n : neighbours[i]) mean += mesh.positions[n];
      const Vec3 offset = mean / static_cast<double>(neighbours[i].size()) - mesh.positions[i];
      moved[i] = mesh.positions[i] + 0.6 * (offset - offset.dot(mesh.normals[i]) * mesh.normals[i]);
    }
    mesh.positions = std::move(moved);
    if (round + 1 == options.smoothing) tolerance = 1e-7;
    parallel_for(blocks, settle);
  }

  for (const auto& q : quads) {
    const auto length = [&](int a, int b) {
      return (mesh.positions[q[a]] - mesh.positions[q[b]]).squaredNorm();
    };
    if (length(0, 2) <= length(1, 3)) {
      mesh.triangles.push_back({q[0], q[1], q[2]});
      mesh.triangles.push_back({q[0], q[2], q[3]});
    } else {
      mesh.triangles.push_back({q[0], q[1], q[3]});
      mesh.triangles.push_back({q[1], q[2], q[3]});
    }
  }
  return mesh;
}

}  // namespace applique::assets
