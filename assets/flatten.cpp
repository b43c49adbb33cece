#include "flatten.h"

#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <fmt/format.h>

namespace applique::assets {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The border in order, or an empty list when there is not exactly one loop.
std::vector<std::uint32_t> border_loop(const FlatChart& chart) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (const Triangle& t : chart.triangles)
    for (int i = 0; i < 3; ++i) sides.insert({t[i], t[(i + 1) % 3]});
  std::map<std::uint32_t, std::uint32_t> next;
  std::size_t count = 0;
  for (const auto& [a, b] : sides)
    if (!sides.contains({b, a})) {
      next[a] = b;
      ++count;
    }
  std::vector<std::uint32_t> loop;
  if (next.empty() || next.size() != count) return loop;
  for (std::uint32_t v = next.begin()->first; loop.empty() || v != loop.front(); v = next.at(v))
    loop.push_back(v);
  if (loop.size() != count) loop.clear();
  return loop;
}

double signed_area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d ab = b - a;
  const Vector2d ac = c - a;
  return 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
}

/// Tutte's embedding over a circle with the chart's own perimeter, uniform weights.
std::vector<Vector2d> tutte(const FlatChart& chart, const std::vector<std::uint32_t>& loop) {
  const auto n = static_cast<int>(chart.positions.size());
  std::vector<Vector2d> uvs(n, Vector2d::Zero());
  std::vector<double> along{0};
  for (std::size_t i = 0; i < loop.size(); ++i)
    along.push_back(along.back() +
                    (chart.positions[loop[i]] - chart.positions[loop[(i + 1) % loop.size()]]).norm());
  const double radius = along.back() / (2 * std::numbers::pi);
  std::vector<bool> fixed(n, false);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double angle = along[i] / radius;
    uvs[loop[i]] = radius * Vector2d(std::cos(angle), std::sin(angle));
    fixed[loop[i]] = true;
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n, 2);
  for (const Triangle& t : chart.triangles)
    for (int i = 0; i < 3; ++i) {
      // Each edge inside the chart is met twice, once from each side.
      const auto a = static_cast<int>(t[i]);
      const auto b = static_cast<int>(t[(i + 1) % 3]);
      if (fixed[a]) continue;
      entries.emplace_back(a, a, 1);
      if (fixed[b])
        right.row(a) += uvs[b].transpose();
      else
        entries.emplace_back(a, b, -1);
    }
  for (int v = 0; v < n; ++v)
    if (fixed[v]) {
      entries.emplace_back(v, v, 1);
      right.row(v) = uvs[v].transpose();
    }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixX2d solution = solver.solve(right);
  for (int v = 0; v < n; ++v) uvs[v] = solution.row(v).transpose();
  return uvs;
}

/// Local/global iteration from `start`: each triangle's best rotation, then one linear solve.
std::vector<Vector2d> as_rigid_as_possible(const FlatChart& chart, std::vector<Vector2d> uvs,
                                           int iterations) {
  const auto n = static_cast<int>(chart.positions.size());
  struct Flat {
    std::array<Vector2d, 3> corner;   // the triangle laid in the plane
    std::array<double, 3> cotangent;  // of the angle opposite side i
  };
  std::vector<Flat> flat(chart.triangles.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t f = 0; f < flat.size(); ++f) {
    const Triangle& t = chart.triangles[f];
    const Vec3 ab = chart.positions[t[1]] - chart.positions[t[0]];
    const Vec3 ac = chart.positions[t[2]] - chart.positions[t[0]];
    const double length = ab.norm();
    flat[f].corner = {Vector2d::Zero(), Vector2d(length, 0),
                      Vector2d(ac.dot(ab) / length, ab.cross(ac).norm() / length)};
    for (int i = 0; i < 3; ++i) {
      const Vector2d a = flat[f].corner[i] - flat[f].corner[(i + 2) % 3];
      const Vector2d b = flat[f].corner[(i + 1) % 3] - flat[f].corner[(i + 2) % 3];
      // Obtuse triangles get a small positive weight, so that the system stays definite.
      const double weight =
          std::max(a.dot(b) / std::max(std::abs(a.x() * b.y() - a.y() * b.x()), 1e-12), 0.02);
      flat[f].cotangent[i] = weight;
      const auto u = static_cast<int>(t[i]);
      const auto v = static_cast<int>(t[(i + 1) % 3]);
      for (const auto& [row, column, value] : {std::tuple(u, u, weight), std::tuple(v, v, weight),
                                               std::tuple(u, v, -weight), std::tuple(v, u, -weight)})
        entries.emplace_back(row, column, value);
    }
  }
  entries.emplace_back(0, 0, 1.0);  // holds the chart in place
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  for (int round = 0; round < iterations; ++round) {
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n, 2);
    right.row(0) = uvs[0].transpose();
    for (std::size_t f = 0; f < flat.size(); ++f) {
      const Triangle& t = chart.triangles[f];
      // The best rotation maximises Σ cot (u_i - u_j) · R (x_i - x_j): as complex numbers, its direction is
      // theirs.
      double c = 0;
      double s = 0;
      for (int i = 0; i < 3; ++i) {
        const Vector2d x = flat[f].corner[i] - flat[f].corner[(i + 1) % 3];
        const Vector2d u = uvs[t[i]] - uvs[t[(i + 1) % 3]];
        c += flat[f].cotangent[i] * u.dot(x);
        s += flat[f].cotangent[i] * (x.x() * u.y() - x.y() * u.x());
      }
      const double length = std::max(std::hypot(c, s), 1e-300);
      Matrix2d rotation;
      rotation << c / length, -s / length, s / length, c / length;
      for (int i = 0; i < 3; ++i) {
        const Vector2d x =
            flat[f].cotangent[i] * (rotation * (flat[f].corner[i] - flat[f].corner[(i + 1) % 3]));
        right.row(t[i]) += x.transpose();
        right.row(t[(i + 1) % 3]) -= x.transpose();
      }
    }
    const Eigen::MatrixX2d solution = solver.solve(right);
    for (int v = 0; v < n; ++v) uvs[v] = solution.row(v).transpose();
  }
  return uvs;
}

/// Moves the vertices around flipped triangles to the means of their neighbours, in areas that grow a ring
/// every few rounds, until nothing is flipped. False when it stays folded, as where the border itself turns
/// over.
bool unfold(FlatChart& chart, const std::vector<std::uint32_t>& loop) {
  std::vector<std::vector<std::uint32_t>> neighbours(chart.positions.size());
  for (const Triangle& t : chart.triangles)
    for (int i = 0; i < 3; ++i) neighbours[t[i]].push_back(t[(i + 1) % 3]);
  for (const std::uint32_t v : loop) neighbours[v].clear();  // the border stays
  std::vector<bool> moves(chart.positions.size(), false);
  for (int round = 0; round < 100; ++round) {
    bool folded = false;
    for (const Triangle& t : chart.triangles)
      if (signed_area(chart.uvs[t[0]], chart.uvs[t[1]], chart.uvs[t[2]]) <= 0) {
        folded = true;
        for (const std::uint32_t v : t) moves[v] = true;
      }
    if (!folded) return true;
    if (round % 5 == 4) {
      const std::vector<bool> before = moves;
      for (std::size_t v = 0; v < neighbours.size(); ++v)
        if (before[v])
          for (const std::uint32_t n : neighbours[v]) moves[n] = true;
    }
    for (std::size_t v = 0; v < neighbours.size(); ++v) {
      if (!moves[v] || neighbours[v].empty()) continue;
      Vector2d sum = Vector2d::Zero();
      for (const std::uint32_t n : neighbours[v]) sum += chart.uvs[n];
      chart.uvs[v] = sum / static_cast<double>(neighbours[v].size());
    }
  }
  return false;
}

}  // namespace

Result<void> flatten(FlatChart& chart) {
  const auto loop = border_loop(chart);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : chart.triangles)
    for (int i = 0; i < 3; ++i) edges.insert(std::minmax(t[i], t[(i + 1) % 3]));
  const auto euler = static_cast<std::ptrdiff_t>(chart.positions.size() + chart.triangles.size()) -
                     static_cast<std::ptrdiff_t>(edges.size());
  if (loop.empty() || euler != 1)
    return fail(ErrorCode::not_solved,
                fmt::format("the chart is not a disc (Euler characteristic {}, {} triangles)", euler,
                            chart.triangles.size()));
  chart.uvs = as_rigid_as_possible(chart, tutte(chart, loop), 80);
  if (!unfold(chart, loop)) return fail(ErrorCode::not_solved, "the chart folds over itself");
  return {};
}

}  // namespace applique::assets
