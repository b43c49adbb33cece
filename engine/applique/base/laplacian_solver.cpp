#include "applique/base/laplacian_solver.h"

#include <complex>
#include <limits>

namespace applique {
namespace {

using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Of two real vectors each: both systems are one with twice the unknowns.
double inner(const VectorXcd& p, const VectorXcd& q) {
  return p.dot(q).real();
}

}  // namespace

bool LaplacianSolver::small(const Matrix& lower) const {
  return static_cast<std::size_t>(lower.rows()) <= options_.most_factored;
}

void LaplacianSolver::analyse(const Matrix& lower) {
  if (small(lower)) factors_.analyzePattern(lower);
}

bool LaplacianSolver::renew(const Matrix& lower) {
  multigrid_.reset();
  if (!small(lower)) {
    multigrid_.emplace(symmetric_rows(lower));
    if (multigrid_->positive_definite()) return true;
    multigrid_.reset();
    factors_.analyzePattern(lower);
  }
  factors_.factorize(lower);
  return factors_.info() == Eigen::Success;
}

bool LaplacianSolver::compute(const Matrix& lower) {
  analyse(lower);
  return renew(lower);
}

VectorXcd LaplacianSolver::solve(const VectorXcd& right) {
  if (multigrid_) {
    if (auto solution = iterate(right)) return *std::move(solution);
    iterations_ = 0;
    factors_.compute(columns_of_symmetric(multigrid_->matrix()));
    multigrid_.reset();
  }
  if (factors_.info() != Eigen::Success)
    return VectorXcd::Constant(right.size(), std::numeric_limits<double>::quiet_NaN());
  return solve_by_factors(right);
}

VectorXd LaplacianSolver::solve(const VectorXd& right) {
  return solve(VectorXcd(right.cast<std::complex<double>>())).real();
}

VectorXcd LaplacianSolver::solve_by_factors(const VectorXcd& right) const {
  using Pairs = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
  VectorXcd solution(right.size());
  Eigen::Map<Pairs>(reinterpret_cast<double*>(solution.data()), right.size(), 2) =
      factors_.solve(Eigen::Map<const Pairs>(reinterpret_cast<const double*>(right.data()), right.size(), 2));
  return solution;
}

/// Preconditioned conjugate gradients (Hestenes and Stiefel 1952) from zero. The residual's product with its
/// V-cycle is, up to the V-cycle's quality, the square of the error's energy norm.
std::optional<VectorXcd> LaplacianSolver::iterate(const VectorXcd& right) {
  const Eigen::Index size = right.size();
  VectorXcd solution = VectorXcd::Zero(size), residual = right, cycled(size), image(size);
  multigrid_->cycle(residual, cycled);
  VectorXcd direction = cycled;
  double error = inner(residual, cycled);
  const double tolerated = options_.tolerance * options_.tolerance * error;
  for (iterations_ = 0; iterations_ < options_.max_iterations; ++iterations_) {
    if (error <= tolerated) return solution;
    image.setZero();
    add_product(multigrid_->matrix(), direction, 1, image);
    const double curvature = inner(direction, image);
    if (!(curvature > 0)) return std::nullopt;
    solution += error / curvature * direction;
    residual -= error / curvature * image;
    multigrid_->cycle(residual, cycled);
    const double next = inner(residual, cycled);
    if (!(next >= 0)) return std::nullopt;
    direction = cycled + next / error * direction;
    error = next;
  }
  return std::nullopt;
}

}  // namespace applique
