#include "applique/embed/untangle.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include "applique/base/predicates.h"
#include "applique/embed/lbfgs.h"
#include "applique/embed/triangle_energy.h"

namespace applique {
namespace {

constexpr double worst_aspect = 10;  // of a triangle whose shape is worth keeping
constexpr int most_steps = 40;       // within one
constexpr int finishing_rounds = 3;  // once nothing is turned over
constexpr double least_epsilon = 1e-9;

/// The regularised energy: what a triangle's map does to angles and areas, over a determinant that stays
/// positive.
struct Foldover {
  double epsilon;

  [[nodiscard]] double regularised(double det) const { return 0.5 * (det + std::hypot(epsilon, det)); }

  EnergyDensity operator()(double mean_square, double det) const {
    const double root = std::hypot(epsilon, det);
    // Without cancellation where det is far below zero.
    const double chi = det >= 0 ? 0.5 * (det + root) : 0.5 * epsilon * epsilon / (root - det);
    const double sum = mean_square + 0.5 * (1 + det * det);
    return {sum / chi, 1 / chi, det / chi - sum / (chi * root)};
  }
};

/// A sliver has no shape worth keeping: an equilateral triangle of its area stands for it.
RestTriangle rest_of(const std::array<Vec2, 3>& corners) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, std::abs(corners[(k + 1) % 3] - corners[k]));
  const double area = 0.5 * cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (area > 0 && longest * longest < 2 * worst_aspect * area) return RestTriangle(corners);
  const double side =
      std::sqrt(std::max(area, longest * longest / 2 / worst_aspect / worst_aspect) * 4 / std::sqrt(3.0));
  return RestTriangle({Vec2(0), Vec2(side), side * Vec2(0.5, 0.5 * std::sqrt(3.0))});
}

/// The Laplacian of the vertices that may move, and how to move them without moving the placed points.
class ConstrainedLaplacian {
 public:
  ConstrainedLaplacian(const Tangle& tangle, std::span<const RestTriangle> rest)
      : row_(tangle.fixed.size(), -1) {
    int rows = 0;
    for (std::size_t v = 0; v < row_.size(); ++v)
      if (!tangle.fixed[v]) row_[v] = rows++;
    assemble(tangle, rest, rows);
    constrain(tangle, rows);
  }

  [[nodiscard]] bool usable() const { return solver_.info() == Eigen::Success; }

  /// The inverse Laplacian of `right`, then as little as it takes to leave the placed points where they are.
  [[nodiscard]] PlanePoints solve(const PlanePoints& right) const {
    Eigen::MatrixX2d x = solver_.solve(gathered(right));
    if (constraints_.rows() > 0) x -= reach_ * pull_.solve(Eigen::MatrixX2d(constraints_ * x));
    return scattered(x, right.size());
  }

  /// The smallest move, by the Laplacian, that brings the placed points to their targets.
  [[nodiscard]] PlanePoints correction(const Tangle& tangle, const PlanePoints& plane) const {
    if (tangle.placed.empty()) return PlanePoints::Zero(plane.size());
    Eigen::MatrixX2d missing(static_cast<Eigen::Index>(tangle.placed.size()), 2);
    for (std::size_t i = 0; i < tangle.placed.size(); ++i) {
      Vec2 rest = tangle.placed[i].target;
      for (int k = 0; k < 3; ++k)
        rest -= tangle.placed[i].barycentric[k] * plane[tangle.placed[i].corners[k]];
      missing.row(static_cast<Eigen::Index>(i)) << rest.real(), rest.imag();
    }
    return scattered(reach_ * pull_.solve(missing), plane.size());
  }

 private:
  void assemble(const Tangle& tangle, std::span<const RestTriangle> rest, int rows) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t t = 0; t < rest.size(); ++t)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int row = row_[tangle.faces[t][i]], column = row_[tangle.faces[t][j]];
          if (row >= 0 && column >= 0)
            entries.emplace_back(row, column, 4 * rest[t].area * dot(rest[t].hat[i], rest[t].hat[j]));
        }
    Eigen::SparseMatrix<double> laplacian(rows, rows);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    const double hold = 1e-6 * laplacian.diagonal().mean();
    for (int i = 0; i < rows; ++i) laplacian.coeffRef(i, i) += hold;
    solver_.compute(laplacian);
  }

  void constrain(const Tangle& tangle, int rows) {
    const auto count = static_cast<Eigen::Index>(tangle.placed.size());
    constraints_ = Eigen::MatrixXd::Zero(count, rows);
    for (Eigen::Index i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        const PlacedPoint& point = tangle.placed[static_cast<std::size_t>(i)];
        if (const int row = row_[point.corners[k]]; row >= 0) constraints_(i, row) += point.barycentric[k];
      }
    reach_ = solver_.solve(constraints_.transpose());
    // Several points in one triangle may be more than it can obey: the least squares then.
    if (count > 0) pull_.compute(constraints_ * reach_);
  }

  [[nodiscard]] Eigen::MatrixX2d gathered(const PlanePoints& points) const {
    Eigen::MatrixX2d x(constraints_.cols(), 2);
    for (std::size_t v = 0; v < row_.size(); ++v)
      if (row_[v] >= 0)
        x.row(row_[v]) << points[static_cast<int>(v)].real(), points[static_cast<int>(v)].imag();
    return x;
  }

  [[nodiscard]] PlanePoints scattered(const Eigen::MatrixX2d& x, Eigen::Index size) const {
    PlanePoints points = PlanePoints::Zero(size);
    for (std::size_t v = 0; v < row_.size(); ++v)
      if (row_[v] >= 0) points[static_cast<int>(v)] = {x(row_[v], 0), x(row_[v], 1)};
    return points;
  }

  std::vector<int> row_;  ///< By vertex; -1 where it is fixed.
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  Eigen::MatrixXd constraints_;  ///< By placed point and row.
  Eigen::MatrixXd reach_;        ///< By row and placed point: how a pull at the point moves the vertices.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> pull_;
};

std::size_t count_turned(const Tangle& tangle, const PlanePoints& plane) {
  std::size_t turned = 0;
  for (const auto& f : tangle.faces) turned += orientation(plane[f[0]], plane[f[1]], plane[f[2]]) <= 0;
  return turned;
}

double least_det(const Tangle& tangle, std::span<const RestTriangle> rest, const PlanePoints& plane) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < rest.size(); ++t)
    least = std::min(least, TriangleMap(rest[t], tangle.faces[t], plane).det());
  return least;
}

/// L-BFGS on the energy of one epsilon; the energy that is reached.
double descend(const Tangle& tangle, std::span<const RestTriangle> rest,
               const ConstrainedLaplacian& laplacian, const Foldover& energy, PlanePoints& plane) {
  constexpr double sufficient = 1e-4, tolerance = 1e-4;
  constexpr int most_halvings = 20;
  PlanePoints gradient, next, next_gradient;
  double value = triangle_energy(tangle.faces, rest, plane, energy, gradient);
  StepHistory history;
  for (int step = 0; step < most_steps; ++step) {
    const PlanePoints direction =
        history.direction([&](const PlanePoints& right) { return laplacian.solve(right); }, gradient);
    const double slope = StepHistory::inner(gradient, direction);
    double reached = value;
    double t = 1;
    for (int halving = 0; halving < most_halvings; ++halving, t *= 0.5) {
      next = plane + t * direction;
      reached = triangle_energy(tangle.faces, rest, next, energy, next_gradient);
      if (reached <= value + sufficient * t * slope) break;
    }
    if (!(reached < value)) break;
    history.add(next - plane, next_gradient - gradient);
    const bool small = value - reached < tolerance * value;
    std::swap(plane, next);
    std::swap(gradient, next_gradient);
    value = reached;
    if (small) break;
  }
  return value;
}

}  // namespace

Untangled untangle(const Tangle& tangle, std::vector<Vec2> plane, const UntangleOptions& options) {
  std::vector<RestTriangle> rest;
  for (const auto& corners : tangle.rest) rest.push_back(rest_of(corners));
  PlanePoints at = Eigen::Map<const PlanePoints>(plane.data(), static_cast<Eigen::Index>(plane.size()));
  const ConstrainedLaplacian laplacian(tangle, rest);
  if (!laplacian.usable()) return {std::move(plane), count_turned(tangle, at)};
  at += laplacian.correction(tangle, at);

  double least = least_det(tangle, rest, at);
  Foldover energy{std::sqrt(1e-12 + 0.04 * std::min(0.0, least) * std::min(0.0, least))};
  PlanePoints gradient;
  double before = triangle_energy(tangle.faces, rest, at, energy, gradient);
  int finishing = 0;
  for (int round = 0; round < options.max_rounds && finishing < finishing_rounds; ++round) {
    const double value = descend(tangle, rest, laplacian, energy, at);
    if (count_turned(tangle, at) == 0) ++finishing;
    // The next epsilon: as small as the energy's fall allows (§4 of Garanzha et al.).
    least = least_det(tangle, rest, at);
    const double sigma = std::max(1 - value / before, 0.1), wanted = (1 - sigma) * energy.regularised(least);
    energy.epsilon =
        least < wanted ? std::max(least_epsilon, 2 * std::sqrt(wanted * (wanted - least))) : least_epsilon;
    before = triangle_energy(tangle.faces, rest, at, energy, gradient);
  }
  at += laplacian.correction(tangle, at);  // what rounding has moved
  return {{at.data(), at.data() + at.size()}, count_turned(tangle, at)};
}

}  // namespace applique
