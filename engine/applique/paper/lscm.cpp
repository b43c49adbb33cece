#include "applique/paper/lscm.h"

#include <cmath>

#include <Eigen/IterativeLinearSolvers>

namespace applique {
namespace {

constexpr double tolerance = 1e-6;

using Matrix = Eigen::SparseMatrix<Vec2>;
using Vector = Eigen::VectorXcd;

}  // namespace

LscmResult solve_lscm(const DiscGeometry& disc, const std::vector<Vec2>& start,
                      std::array<std::size_t, 2> pins) {
  LscmResult result{start, 0, 0};
  std::vector<int> row(disc.vertices, -1);
  int rows = 0;
  for (std::size_t v = 0; v < disc.vertices; ++v)
    if (v != pins[0] && v != pins[1]) row[v] = rows++;
  if (rows == 0) return result;

  std::vector<Eigen::Triplet<Vec2>> entries;
  Vector right = Vector::Zero(rows);
  const auto add = [&](int a, int b, Vec2 value) {
    if (row[a] < 0) return;
    if (row[b] >= 0)
      entries.emplace_back(row[a], row[b], value);
    else
      right[row[a]] -= value * start[b];
  };
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = disc.faces[t][(k + 1) % 3], b = disc.faces[t][(k + 2) % 3];
      const double w = 0.5 * disc.cotangents[t][k];
      add(a, a, w);
      add(b, b, w);
      add(a, b, -w);
      add(b, a, -w);
    }
  for (std::size_t i = 0; i < disc.boundary.size(); ++i) {
    const int a = disc.boundary[i], b = disc.boundary[(i + 1) % disc.boundary.size()];
    add(a, b, Vec2(0, 0.5));
    add(b, a, Vec2(0, -0.5));
  }
  Matrix matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());

  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver(matrix);
  solver.setTolerance(tolerance);
  solver.setMaxIterations(100 + static_cast<Eigen::Index>(4 * std::sqrt(static_cast<double>(disc.vertices))));
  Vector guess(rows);
  for (std::size_t v = 0; v < disc.vertices; ++v)
    if (row[v] >= 0) guess[row[v]] = start[v];
  const Vector solved = solver.solveWithGuess(right, guess);
  for (std::size_t v = 0; v < disc.vertices; ++v)
    if (row[v] >= 0) result.plane[v] = solved[row[v]];
  result.iterations = static_cast<int>(solver.iterations());
  result.residual = solver.error();
  return result;
}

}  // namespace applique
