#include "applique/embed/least_stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "applique/base/laplacian_solver.h"
#include "applique/embed/collapse.h"
#include "applique/embed/lbfgs.h"
#include "applique/embed/triangle_energy.h"

namespace applique {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

std::vector<RestTriangle> rest_triangles(const DiscGeometry& disc) {
  std::vector<RestTriangle> rest;
  for (std::size_t t = 0; t < disc.faces.size(); ++t) rest.emplace_back(disc.flat(t));
  return rest;
}

/// The energy of a unit of area, by how a triangle's map stretches it: the mean square of its two stretches,
/// and their product `det` > 0.
struct Distortion {
  double isometry;

  EnergyDensity operator()(double mean_square, double det) const {
    if (!(det > 0)) return {std::numeric_limits<double>::infinity(), 0, 0};
    const double inverse = 1 / det, square = inverse * inverse, conformity = 2 * (1 - isometry);
    return {isometry * (mean_square * square + det) + conformity * mean_square * inverse,
            isometry * square + conformity * inverse,
            isometry * (1 - 2 * mean_square * square * inverse) - conformity * mean_square * square};
  }
};

/// How stiff a triangle is along a stretch `s`: the slope of the energy's parts there over s - 1.
double stiffness(double s, double across, double isometry) {
  const double inverse = 1 / s;
  return isometry * inverse * (1 + inverse + inverse * inverse) + 2 * (1 - isometry) * inverse / across;
}

constexpr double guide_strength = 100;

// Draws points of the disc to their targets.
class Guide {
 public:
  Guide(const DiscGeometry& disc, std::span<const PlacedPoint> points) : points_(points) {
    Vec2 middle = 0;
    double spread = 0;
    for (const PlacedPoint& point : points) middle += point.target / static_cast<double>(points.size());
    for (const PlacedPoint& point : points) spread += std::norm(point.target - middle);
    weight_ = spread > 0 ? guide_strength * disc.area / spread : 0;
  }

  // Adds its part to the gradient.
  double energy(const PlanePoints& plane, PlanePoints& gradient) const {
    double sum = 0;
    for (const auto& [corners, barycentric, target] : points_) {
      Vec2 away = -target;
      for (std::size_t k = 0; k < 3; ++k) away += barycentric[k] * plane[corners[k]];
      sum += weight_ * std::norm(away);
      for (std::size_t k = 0; k < 3; ++k) gradient[corners[k]] += 2 * weight_ * barycentric[k] * away;
    }
    return sum;
  }

  // Calls add(row, column, value) for the lower triangle of its part of the Hessian.
  template <class Add>
  void for_each_stiffness(Add add) const {
    for (const PlacedPoint& point : points_)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          const auto [column, row] = std::minmax(point.corners[i], point.corners[j]);
          add(row, column, 2 * weight_ * point.barycentric[i] * point.barycentric[j]);
        }
  }

 private:
  std::span<const PlacedPoint> points_;
  double weight_ = 0;
};

/// The Laplacian that stands for the energy's Hessian; its pattern is built once.
class WeightedLaplacian {
 public:
  WeightedLaplacian(const DiscGeometry& disc, const std::vector<RestTriangle>& rest, double isometry)
      : disc_(disc), rest_(rest), isometry_(isometry) {
    const auto size = static_cast<Eigen::Index>(disc.vertices);
    std::vector<Eigen::Triplet<double>> pattern;
    pattern.reserve(6 * disc.faces.size());
    for_each_entry([&](std::size_t, int, int row, int column) { pattern.emplace_back(row, column, 0); });
    matrix_.resize(size, size);
    matrix_.setFromTriplets(pattern.begin(), pattern.end());
    slots_.resize(disc.faces.size());
    for_each_entry([&](std::size_t t, int entry, int row, int column) {
      const int* first = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
      const int* last = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
      slots_[t][entry] = static_cast<int>(std::lower_bound(first, last, row) - matrix_.innerIndexPtr());
    });
    solver_.analyse(matrix_);
  }

  /// Weighs the triangles by how `plane` stretches them; false when the matrix cannot be factored.
  bool renew(const PlanePoints& plane, const Guide& guide) {
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
    for (std::size_t t = 0; t < rest_.size(); ++t)
      add_triangle(t, TriangleMap(rest_[t], disc_.faces[t], plane));
    guide.for_each_stiffness(
        [&](int row, int column, double value) { matrix_.coeffRef(row, column) += value; });
    // The energy does not see motions of the plane: a trace of the diagonal holds them.
    const double hold = 1e-8 * matrix_.diagonal().mean();
    for (Eigen::Index i = 0; i < matrix_.rows(); ++i) matrix_.coeffRef(i, i) += hold;
    return solver_.renew(matrix_);
  }

  [[nodiscard]] PlanePoints solve(const PlanePoints& right) { return solver_.solve(right); }

 private:
  /// Calls visit(face, entry, row, column) for the lower triangle of each face's 3 x 3 block.
  template <class Visit>
  void for_each_entry(Visit visit) const {
    for (std::size_t t = 0; t < disc_.faces.size(); ++t) {
      int entry = 0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) {
          const auto [column, row] = std::minmax(disc_.faces[t][i], disc_.faces[t][j]);
          visit(t, entry++, row, column);
        }
    }
  }

  void add_triangle(std::size_t t, const TriangleMap& map) {
    const double a = std::abs(map.a), b = std::abs(map.b);
    const double along = stiffness(a + b, a - b, isometry_), across = stiffness(a - b, a + b, isometry_);
    // The direction of the larger stretch, as a square; any when both are the same.
    const Vec2 direction = b > 0 ? map.b * std::conj(map.a) / (a * b) : Vec2(0);
    const double both = 2 * rest_[t].area * (along + across);
    const Vec2 apart = 2 * rest_[t].area * (along - across) * direction;
    int entry = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) {
        const Vec2 p = rest_[t].hat[i], q = rest_[t].hat[j];
        matrix_.valuePtr()[slots_[t][entry++]] += both * dot(p, q) + dot(apart, p * q);
      }
  }

  const DiscGeometry& disc_;
  const std::vector<RestTriangle>& rest_;
  double isometry_;
  SparseMatrix matrix_;  // lower triangle
  std::vector<std::array<int, 6>> slots_;
  // L-BFGS corrects the rest. With one V-cycle in place of a solution it takes twice the steps and stops
  // short.
  LaplacianSolver solver_{{.tolerance = 1e-2}};
};

}  // namespace

std::vector<Vec2> relax_stretch(const DiscGeometry& disc, const std::vector<Vec2>& plane,
                                const StretchOptions& options) {
  constexpr double sufficient = 1e-4;  // Armijo
  constexpr int most_halvings = 12;
  constexpr int most_steps = 10;    // on one Laplacian
  constexpr double outdated = 0.8;  // of the energy at which the Laplacian was weighted
  std::vector<RestTriangle> rest = rest_triangles(disc);
  for (std::size_t t = 0; t < options.weights.size(); ++t) rest[t].area *= options.weights[t];
  const Guide guide(disc, options.guide);
  const auto energy = [&](const PlanePoints& places, PlanePoints& slope) {
    const double stretch = triangle_energy(disc.faces, rest, places, Distortion{options.isometry}, slope);
    return stretch + guide.energy(places, slope);
  };
  PlanePoints at = Eigen::Map<const PlanePoints>(plane.data(), static_cast<Eigen::Index>(plane.size()));
  PlanePoints gradient, next, next_gradient;
  double value = energy(at, gradient);
  if (!std::isfinite(value)) return plane;
  WeightedLaplacian laplacian(disc, rest, options.isometry);
  StepHistory history;
  double weighted_at = 0;
  int steps = most_steps, small = 0;
  for (int iteration = 0; iteration < options.max_iterations && small < 2; ++iteration) {
    if (steps == most_steps || value < outdated * weighted_at) {
      if (!laplacian.renew(at, guide)) break;
      history.clear();
      weighted_at = value;
      steps = 0;
    }
    const PlanePoints direction =
        history.direction([&](const PlanePoints& right) { return laplacian.solve(right); }, gradient);
    const double slope = StepHistory::inner(gradient, direction);
    next = at + direction;
    double t =
        std::min(1.0, 0.9 * first_collapse(disc, {at.data(), plane.size()}, {next.data(), plane.size()}));
    double reached = std::numeric_limits<double>::infinity();
    for (int halving = 0; halving < most_halvings; ++halving, t *= 0.5) {
      next = at + t * direction;
      reached = energy(next, next_gradient);
      if (reached <= value + sufficient * t * slope) break;
    }
    if (!(reached < value)) {
      // No way down along this direction: with a new Laplacian there may be one.
      if (steps == 0) break;
      steps = most_steps;
      continue;
    }
    history.add(next - at, next_gradient - gradient);
    small = value - reached < options.tolerance * value ? small + 1 : 0;
    std::swap(at, next);
    std::swap(gradient, next_gradient);
    value = reached;
    ++steps;
  }
  return {at.data(), at.data() + at.size()};
}

}  // namespace applique
