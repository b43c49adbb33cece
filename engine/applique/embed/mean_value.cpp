#include "applique/embed/mean_value.h"

#include <cmath>
#include <numbers>

#include <Eigen/SparseLU>

namespace applique {

void place_by_mean_value(const DiscGeometry& disc, const std::vector<char>& free, std::vector<Vec2>& plane) {
  std::vector<int> row(disc.vertices, -1);
  int rows = 0;
  for (std::size_t v = 0; v < disc.vertices; ++v)
    if (free[v]) row[v] = rows++;
  if (rows == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(rows, 2);
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int v = disc.faces[t][k];
      if (row[v] < 0) continue;
      const double half = std::tan(0.5 * disc.angle(t, k));
      for (int other : {(k + 1) % 3, (k + 2) % 3}) {
        const int w = disc.faces[t][other];
        // The edge from corner k to `other` is opposite the third corner.
        const double weight = half / disc.lengths[t][3 - k - other];
        entries.emplace_back(row[v], row[v], weight);
        if (row[w] >= 0)
          entries.emplace_back(row[v], row[w], -weight);
        else
          right.row(row[v]) += weight * Eigen::RowVector2d(plane[w].real(), plane[w].imag());
      }
    }
  Eigen::SparseMatrix<double> matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixX2d solved = solver.solve(right);
  for (std::size_t v = 0; v < disc.vertices; ++v)
    if (row[v] >= 0) plane[v] = Vec2(solved(row[v], 0), solved(row[v], 1));
}

std::vector<Vec2> embed_on_circle(const DiscGeometry& disc) {
  const std::size_t rim = disc.boundary.size();
  std::vector<int> place(disc.vertices, -1);
  for (std::size_t i = 0; i < rim; ++i) place[disc.boundary[i]] = static_cast<int>(i);
  std::vector<double> length(rim, 0);
  double perimeter = 0;
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = place[disc.faces[t][(k + 1) % 3]], b = place[disc.faces[t][(k + 2) % 3]];
      if (a < 0 || b != static_cast<int>((a + 1) % rim)) continue;
      length[a] = disc.lengths[t][k];
      perimeter += length[a];
    }
  const double radius = std::sqrt(disc.area / std::numbers::pi);
  std::vector<Vec2> plane(disc.vertices);
  std::vector<char> free(disc.vertices, true);
  double along = 0;
  for (std::size_t i = 0; i < rim; ++i) {
    plane[disc.boundary[i]] = std::polar(radius, 2 * std::numbers::pi * along / perimeter);
    free[disc.boundary[i]] = false;
    along += length[i];
  }
  place_by_mean_value(disc, free, plane);
  return plane;
}

}  // namespace applique
