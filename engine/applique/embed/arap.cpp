#include "applique/embed/arap.h"

#include <algorithm>
#include <cmath>

#include "applique/base/laplacian_solver.h"

namespace applique {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// The cotangent Laplacian with vertex 0 held (its row and column dropped); the lower triangle.
Matrix held_laplacian(const DiscGeometry& disc) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * disc.faces.size());
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const double w = disc.cotangents[t][k];
      const int a = disc.faces[t][(k + 1) % 3] - 1, b = disc.faces[t][(k + 2) % 3] - 1;
      if (a >= 0) entries.emplace_back(a, a, w);
      if (b >= 0) entries.emplace_back(b, b, w);
      if (a < 0 || b < 0) continue;
      entries.emplace_back(std::max(a, b), std::min(a, b), -w);
    }
  const auto n = static_cast<Eigen::Index>(disc.vertices - 1);
  Matrix laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

}  // namespace

std::vector<Vec2> relax_arap(const DiscGeometry& disc, std::vector<Vec2> plane, const ArapOptions& options) {
  if (disc.faces.size() < 2) return plane;
  LaplacianSolver solver;
  if (!solver.compute(held_laplacian(disc))) return plane;

  std::vector<std::array<Vec2, 3>> edges(
      disc.faces.size());  // of the flat triangles, edge k opposite corner k
  double mean_edge = 0;
  for (std::size_t t = 0; t < disc.faces.size(); ++t) {
    const auto corner = disc.flat(t);
    for (int k = 0; k < 3; ++k) {
      edges[t][k] = corner[(k + 2) % 3] - corner[(k + 1) % 3];
      mean_edge += disc.lengths[t][k];
    }
  }
  mean_edge /= static_cast<double>(3 * disc.faces.size());

  const Vec2 held = plane[0];
  Eigen::VectorXcd right(static_cast<Eigen::Index>(disc.vertices));
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    right.setZero();
    for (std::size_t t = 0; t < disc.faces.size(); ++t) {
      const auto& f = disc.faces[t];
      // Local step: the rotation nearest to the triangle's map, a phase since the plane is complex.
      Vec2 fit = 0;
      for (int k = 0; k < 3; ++k)
        fit +=
            disc.cotangents[t][k] * (plane[f[(k + 2) % 3]] - plane[f[(k + 1) % 3]]) * std::conj(edges[t][k]);
      const double size = std::abs(fit);
      const Vec2 rotation = size > 0 ? fit / size : Vec2(1);
      for (int k = 0; k < 3; ++k) {
        const Vec2 pull = disc.cotangents[t][k] * rotation * edges[t][k];
        right[f[(k + 2) % 3]] += pull;
        right[f[(k + 1) % 3]] -= pull;
      }
    }
    const Eigen::VectorXcd solved = solver.solve(Eigen::VectorXcd(right.tail(right.size() - 1)));
    double moved = 0;
    for (std::size_t v = 1; v < disc.vertices; ++v) {
      const Vec2 next = held + solved[static_cast<Eigen::Index>(v - 1)];
      moved = std::max(moved, std::abs(next - plane[v]));
      plane[v] = next;
    }
    if (moved < options.tolerance * mean_edge) break;
  }
  return plane;
}

}  // namespace applique
