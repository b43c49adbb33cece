#include "applique/embed/symmetric_dirichlet.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "applique/base/laplacian_solver.h"
#include "applique/embed/collapse.h"

namespace applique {
namespace {

using Points = Eigen::VectorXcd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// A triangle at rest: its area, and half the gradients of its corners' hat functions.
struct RestTriangle {
  double area;
  std::array<Vec2, 3> hat;
};

std::vector<RestTriangle> rest_triangles(const DiscGeometry& disc) {
  std::vector<RestTriangle> rest(disc.faces.size());
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const auto corner = disc.flat(t);
    rest[t].area = 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]);
    for (int k = 0; k < 3; ++k)
      rest[t].hat[k] = Vec2(0, 0.25) * (corner[(k + 2) % 3] - corner[(k + 1) % 3]) / rest[t].area;
  }
  return rest;
}

/// A triangle's map z -> a z + b conj(z): it stretches by |a| + |b| and |a| - |b|, and areas by the product.
struct LinearMap {
  Vec2 a = 0, b = 0;

  LinearMap(const RestTriangle& rest, const std::array<int, 3>& f, const Points& plane) {
    for (int k = 0; k < 3; ++k) {
      a += plane[f[k]] * std::conj(rest.hat[k]);
      b += plane[f[k]] * rest.hat[k];
    }
  }
};

/// The energy at `plane`, infinite unless all triangles keep their orientation, and its gradient.
double energy(const DiscGeometry& disc, const std::vector<RestTriangle>& rest, const Points& plane,
              Points& gradient) {
  double sum = 0;
  gradient.setZero(plane.size());
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const auto& f = disc.faces[t];
    const auto [a, b] = LinearMap(rest[t], f, plane);
    const double det = std::norm(a) - std::norm(b), mean_square = std::norm(a) + std::norm(b);
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    const double spread = 1 + 1 / (det * det), squeeze = 2 * mean_square / (det * det * det);
    sum += rest[t].area * mean_square * spread;
    const Vec2 by_a = 2 * rest[t].area * (spread - squeeze) * a,
               by_b = 2 * rest[t].area * (spread + squeeze) * b;
    for (int k = 0; k < 3; ++k) gradient[f[k]] += by_a * rest[t].hat[k] + by_b * std::conj(rest[t].hat[k]);
  }
  return sum;
}

/// The slope of the energy along a stretch, over the stretch's distance from 1: how stiff a triangle is.
double stiffness(double s) {
  return (1 + 1 / s) * (1 + 1 / (s * s));
}

/// The Laplacian that stands for the energy's Hessian; its pattern is built once.
class WeightedLaplacian {
 public:
  WeightedLaplacian(const DiscGeometry& disc, const std::vector<RestTriangle>& rest)
      : disc_(disc), rest_(rest) {
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
  bool renew(const Points& plane) {
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
    for (std::size_t t = 0; t < rest_.size(); ++t)
      add_triangle(t, LinearMap(rest_[t], disc_.faces[t], plane));
    // The energy does not see motions of the plane: a trace of the diagonal holds them.
    const double hold = 1e-8 * matrix_.diagonal().mean();
    for (Eigen::Index i = 0; i < matrix_.rows(); ++i) matrix_.coeffRef(i, i) += hold;
    return solver_.renew(matrix_);
  }

  [[nodiscard]] Points solve(const Points& right) { return solver_.solve(right); }

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

  void add_triangle(std::size_t t, const LinearMap& map) {
    const double a = std::abs(map.a), b = std::abs(map.b);
    const double along = stiffness(a + b), across = stiffness(a - b);
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
  SparseMatrix matrix_;  // lower triangle
  std::vector<std::array<int, 6>> slots_;
  // L-BFGS corrects the rest. With one V-cycle in place of a solution it takes twice the steps and stops
  // short.
  LaplacianSolver solver_{{.tolerance = 1e-2}};
};

double inner(const Points& p, const Points& q) {
  return p.dot(q).real();
}

/// The steps last taken, by which L-BFGS corrects the Laplacian (two-loop recursion, Nocedal 1980).
class History {
 public:
  void clear() { steps_.clear(); }

  void add(Points step, Points change) {
    const double curvature = inner(step, change);
    if (!(curvature > 0)) return;
    steps_.push_back({std::move(step), std::move(change), curvature});
    if (steps_.size() > memory) steps_.pop_front();
  }

  [[nodiscard]] Points direction(WeightedLaplacian& laplacian, Points gradient) const {
    std::array<double, memory> share;
    for (std::size_t i = steps_.size(); i-- > 0;) {
      share[i] = inner(steps_[i].step, gradient) / steps_[i].curvature;
      gradient -= share[i] * steps_[i].change;
    }
    Points direction = laplacian.solve(gradient);
    for (std::size_t i = 0; i < steps_.size(); ++i)
      direction += (share[i] - inner(steps_[i].change, direction) / steps_[i].curvature) * steps_[i].step;
    return -direction;
  }

 private:
  static constexpr std::size_t memory = 5;
  struct Step {
    Points step, change;  ///< Of the places, and of the gradient.
    double curvature;
  };
  std::deque<Step> steps_;
};

}  // namespace

std::vector<Vec2> relax_symmetric_dirichlet(const DiscGeometry& disc, const std::vector<Vec2>& plane,
                                            const SymmetricDirichletOptions& options) {
  constexpr double sufficient = 1e-4;  // Armijo
  constexpr int most_halvings = 12;
  constexpr int most_steps = 10;    // on one Laplacian
  constexpr double outdated = 0.8;  // of the energy at which the Laplacian was weighted
  const std::vector<RestTriangle> rest = rest_triangles(disc);
  Points at = Eigen::Map<const Points>(plane.data(), static_cast<Eigen::Index>(plane.size()));
  Points gradient, next, next_gradient;
  double value = energy(disc, rest, at, gradient);
  if (!std::isfinite(value)) return plane;
  WeightedLaplacian laplacian(disc, rest);
  History history;
  double weighted_at = 0;
  int steps = most_steps, small = 0;
  for (int iteration = 0; iteration < options.max_iterations && small < 2; ++iteration) {
    if (steps == most_steps || value < outdated * weighted_at) {
      if (!laplacian.renew(at)) break;
      history.clear();
      weighted_at = value;
      steps = 0;
    }
    const Points direction = history.direction(laplacian, gradient);
    const double slope = inner(gradient, direction);
    next = at + direction;
    double t =
        std::min(1.0, 0.9 * first_collapse(disc, {at.data(), plane.size()}, {next.data(), plane.size()}));
    double reached = std::numeric_limits<double>::infinity();
    for (int halving = 0; halving < most_halvings; ++halving, t *= 0.5) {
      next = at + t * direction;
      reached = energy(disc, rest, next, next_gradient);
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
