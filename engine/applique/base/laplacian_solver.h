#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/SparseCholesky>

#include "applique/base/multigrid.h"

namespace applique {

struct LaplacianSolverOptions {
  /// Unknowns up to which the matrix is factored. Measured (benchmarks, solve_laplacian; matrix and one
  /// solution): 32k unknowns 52 ms by factors, 48 by multigrid; 59k 131, 162; 115k 640, 270.
  std::size_t most_factored = 50000;
  double tolerance = 1e-10;  ///< Of the iteration: the error's share of the solution, by energy.
  int max_iterations = 150;
};

/// Solves systems with a symmetric positive definite Laplacian: by its factors (LDL^T) while it is small, by
/// conjugate gradients preconditioned with multigrid where that is faster (§4.1 of the design). Two real
/// right-hand sides, such as the coordinates of the plane, are solved at once as one complex one. An
/// iteration that does not converge gives way to the factors, whatever the size.
class LaplacianSolver {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  explicit LaplacianSolver(const LaplacianSolverOptions& options = {}) : options_(options) {}

  /// Prepares for matrices of this one's pattern. All matrices are given by their lower triangle; what lies
  /// above the diagonal is not looked at.
  void analyse(const Matrix& lower);
  /// Takes a matrix of the pattern that was analysed. False when it is found to be singular.
  [[nodiscard]] bool renew(const Matrix& lower);
  /// Both.
  [[nodiscard]] bool compute(const Matrix& lower);

  /// Not finite when an iteration did not converge and the matrix cannot be factored either.
  [[nodiscard]] Eigen::VectorXcd solve(const Eigen::VectorXcd& right);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right);
  /// That the last `solve` took; 0 by factors.
  [[nodiscard]] int iterations() const { return iterations_; }

 private:
  [[nodiscard]] bool small(const Matrix& lower) const;
  [[nodiscard]] Eigen::VectorXcd solve_by_factors(const Eigen::VectorXcd& right) const;
  [[nodiscard]] std::optional<Eigen::VectorXcd> iterate(const Eigen::VectorXcd& right);

  LaplacianSolverOptions options_;
  Eigen::SimplicialLDLT<Matrix> factors_;
  std::optional<Multigrid> multigrid_;  ///< Empty where the factors stand for the matrix.
  int iterations_ = 0;
};

}  // namespace applique
