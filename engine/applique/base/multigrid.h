#pragma once

#include <vector>

#include <Eigen/SparseCholesky>

#include "applique/base/sparse_rows.h"

namespace applique {

/// Smoothed-aggregation algebraic multigrid (Vanek, Mandel and Brezina 1996) for the Laplacians of
/// triangulations: unknowns that depend strongly on one another form aggregates, which are the unknowns of
/// the next, coarser level. Time and memory grow with the number of unknowns.
///
/// Each cycle sweeps a level forwards before and backwards after it visits the next (Gauss-Seidel). Ranges of
/// rows are swept side by side; what couples them stabilises the diagonal (l1-Gauss-Seidel, Baker et al.
/// 2011), which makes any such sweep converge, negative weights or not, without an estimate of eigenvalues.
class Multigrid {
 public:
  /// `matrix` is symmetric and positive definite.
  explicit Multigrid(SparseRows matrix);

  /// One V-cycle: a fixed, symmetric positive definite approximation to the inverse, for two real vectors at
  /// once as one complex vector. Uses memory of its own: one call at a time.
  void cycle(const Eigen::VectorXcd& right, Eigen::VectorXcd& solution);

  [[nodiscard]] const SparseRows& matrix() const { return levels_.front().matrix; }
  [[nodiscard]] std::size_t levels() const { return levels_.size() + 1; }
  /// False if the coarsest matrix is not positive definite: then no other is.
  [[nodiscard]] bool positive_definite() const { return positive_definite_; }

 private:
  struct Level {
    SparseRows matrix;
    std::vector<double> sweep_diagonal;  ///< What a sweep divides by.
    SparseRows prolongation, restriction;
    Eigen::VectorXcd scratch, coarse_right, coarse_solution;
  };

  void add_level(SparseRows matrix);
  void factor_coarsest(const SparseRows& matrix);
  void cycle(std::size_t depth, const Eigen::VectorXcd& right, Eigen::VectorXcd& solution);

  std::vector<Level> levels_;  ///< All but the coarsest.
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest_;
  bool positive_definite_ = true;
};

}  // namespace applique
