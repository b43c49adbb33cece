#include "applique/embed/boundary_first.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "applique/base/laplacian_solver.h"

namespace applique {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The cotangent Laplacian's blocks: interior-interior, its lower triangle, and interior-boundary.
struct LaplacianBlocks {
  Matrix interior;
  Matrix coupling;
};

/// Where a vertex stands: its row among the interior vertices, or its place on the boundary.
struct Numbering {
  std::vector<int> interior;  ///< -1 on the boundary.
  std::vector<int> boundary;  ///< -1 inside.
  int interior_count = 0;
};

Numbering number_vertices(const DiscGeometry& disc) {
  Numbering n{std::vector<int>(disc.vertices, -1), std::vector<int>(disc.vertices, -1)};
  for (std::size_t i = 0; i < disc.boundary.size(); ++i) n.boundary[disc.boundary[i]] = static_cast<int>(i);
  for (std::size_t v = 0; v < disc.vertices; ++v)
    if (n.boundary[v] < 0) n.interior[v] = n.interior_count++;
  return n;
}

LaplacianBlocks assemble(const DiscGeometry& disc, const Numbering& n) {
  std::vector<Eigen::Triplet<double>> interior, coupling;
  interior.reserve(9 * disc.faces.size());
  for (std::size_t t = 0; t < disc.faces.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const double w = 0.5 * disc.cotangents[t][k];
      const int a = disc.faces[t][(k + 1) % 3], b = disc.faces[t][(k + 2) % 3];
      for (const auto& [i, j] : {std::pair(a, b), std::pair(b, a)}) {
        if (n.interior[i] < 0) continue;
        interior.emplace_back(n.interior[i], n.interior[i], w);
        if (n.interior[j] < 0)
          coupling.emplace_back(n.interior[i], n.boundary[j], -w);
        else if (n.interior[j] < n.interior[i])
          interior.emplace_back(n.interior[i], n.interior[j], -w);
      }
    }
  }
  LaplacianBlocks blocks{Matrix(n.interior_count, n.interior_count),
                         Matrix(n.interior_count, static_cast<int>(disc.boundary.size()))};
  blocks.interior.setFromTriplets(interior.begin(), interior.end());
  blocks.coupling.setFromTriplets(coupling.begin(), coupling.end());
  return blocks;
}

/// The closed boundary polygon with turning angles `turning` and lengths as near as possible to `lengths`.
std::vector<Vec2> lay_out_boundary(const VectorXd& turning, const VectorXd& lengths) {
  const auto n = turning.size();
  std::vector<Vec2> tangent(n);
  double heading = 0, xx = 0, xy = 0, yy = 0;
  Vec2 gap = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i > 0) heading += turning[i];
    tangent[i] = std::polar(1.0, heading);
    gap += lengths[i] * tangent[i];
    xx += lengths[i] * tangent[i].real() * tangent[i].real();
    xy += lengths[i] * tangent[i].real() * tangent[i].imag();
    yy += lengths[i] * tangent[i].imag() * tangent[i].imag();
  }
  // Lengths change by a share l (T . mu) of their own that closes the polygon.
  const double det = xx * yy - xy * xy;
  const Vec2 mu((yy * gap.real() - xy * gap.imag()) / det, (xx * gap.imag() - xy * gap.real()) / det);
  std::vector<Vec2> polygon(n);
  Vec2 at = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    polygon[i] = at;
    at += lengths[i] * (1 - dot(tangent[i], mu)) * tangent[i];
  }
  return polygon;
}

}  // namespace

std::vector<Vec2> flatten_boundary_first(const DiscGeometry& disc, const LaplacianSolverOptions& solving) {
  const Numbering n = number_vertices(disc);
  const auto boundary_count = static_cast<Eigen::Index>(disc.boundary.size());
  const LaplacianBlocks laplacian = assemble(disc, n);
  LaplacianSolver solver(solving);
  if (n.interior_count > 0 && !solver.compute(laplacian.interior))
    return std::vector<Vec2>(disc.vertices, std::numeric_limits<double>::quiet_NaN());

  // Angle defects inside, turning angles on the boundary.
  VectorXd defect = VectorXd::Constant(n.interior_count, 2 * std::numbers::pi);
  VectorXd turning = VectorXd::Constant(boundary_count, std::numbers::pi);
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int v = disc.faces[t][k];
      (n.interior[v] >= 0 ? defect[n.interior[v]] : turning[n.boundary[v]]) -= disc.angle(t, k);
    }
  if (n.interior_count > 0) {
    // The scale factors that flatten the inside with u = 0 on the boundary, and what turning they leave
    // (Cherrier).
    const VectorXd scale = solver.solve(VectorXd(-defect));
    turning += laplacian.coupling.transpose() * scale;
  }
  turning.array() += (2 * std::numbers::pi - turning.sum()) / static_cast<double>(boundary_count);

  VectorXd lengths(boundary_count);
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = n.boundary[disc.faces[t][(k + 1) % 3]], b = n.boundary[disc.faces[t][(k + 2) % 3]];
      if (a >= 0 && b == (a + 1) % boundary_count) lengths[a] = disc.lengths[t][k];
    }
  const std::vector<Vec2> polygon = lay_out_boundary(turning, lengths);

  std::vector<Vec2> plane(disc.vertices);
  for (Eigen::Index i = 0; i < boundary_count; ++i) plane[disc.boundary[i]] = polygon[i];
  if (n.interior_count > 0) {
    const auto rim = Eigen::Map<const VectorXcd>(polygon.data(), boundary_count);
    const VectorXcd inside = solver.solve(VectorXcd(-(laplacian.coupling * rim)));
    for (std::size_t v = 0; v < disc.vertices; ++v)
      if (n.interior[v] >= 0) plane[v] = inside[n.interior[v]];
  }
  return plane;
}

}  // namespace applique
