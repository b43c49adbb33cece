#include "applique/base/multigrid.h"

#include <cmath>

#include "applique/base/parallel.h"
#include "applique/base/types.h"

namespace applique {
namespace {

using Eigen::VectorXcd;

constexpr std::size_t coarse_enough = 1000;  // unknowns
constexpr double least_coarsening = 0.8;     // of a level's unknowns: with more left, the next is the last
constexpr double damping = 4.0 / 3;          // over the row's magnitudes: 2/3 of Jacobi's step, or less
constexpr double strong = 0.08;              // share of the diagonal's geometric mean, on the finest level

/// A level's matrix and which of its unknowns depend strongly on one another. Halving the threshold from
/// level to level is Vanek's choice.
class Couplings {
 public:
  Couplings(const SparseRows& matrix, std::size_t depth)
      : matrix_(matrix),
        threshold_(std::ldexp(strong, -static_cast<int>(depth))),
        diagonal_(matrix.rows(), 0) {
    for (std::size_t i = 0; i < matrix.rows(); ++i)
      for (std::size_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e)
        if (matrix.column[e] == static_cast<int>(i)) diagonal_[i] = matrix.value[e];
  }

  [[nodiscard]] std::size_t size() const { return matrix_.rows(); }

  /// Calls visit(column, value, strong) for the entries of a row beside the diagonal. Positive ones, of
  /// obtuse angles, are weak.
  template <class Visit>
  void for_each(std::size_t i, const Visit& visit) const {
    for (std::size_t e = matrix_.start[i]; e < matrix_.start[i + 1]; ++e) {
      const int j = matrix_.column[e];
      const double value = matrix_.value[e];
      if (j == static_cast<int>(i)) continue;
      visit(j, value, value < 0 && value * value > threshold_ * threshold_ * diagonal_[i] * diagonal_[j]);
    }
  }

  [[nodiscard]] double diagonal(std::size_t i) const { return diagonal_[i]; }

 private:
  const SparseRows& matrix_;
  double threshold_;
  std::vector<double> diagonal_;
};

/// Which aggregate each unknown belongs to; -1 where it depends on no other, and the smoother alone solves
/// it.
struct Aggregates {
  std::vector<int> of;
  int count = 0;
};

/// First whole neighbourhoods that are free; then what is left joins the neighbour it depends on most.
Aggregates aggregate(const Couplings& couplings) {
  Aggregates aggregates{std::vector<int>(couplings.size(), -1)};
  std::vector<int>& of = aggregates.of;
  for (std::size_t i = 0; i < of.size(); ++i) {
    bool free = of[i] < 0, coupled = false;
    couplings.for_each(i, [&](int j, double, bool is_strong) {
      coupled = coupled || is_strong;
      if (is_strong && of[j] >= 0) free = false;
    });
    if (!free || !coupled) continue;
    of[i] = aggregates.count++;
    couplings.for_each(i, [&](int j, double, bool is_strong) {
      if (is_strong) of[j] = of[i];
    });
  }
  const std::vector<int> whole = of;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (whole[i] >= 0) continue;
    double most = 0;
    couplings.for_each(i, [&](int j, double value, bool is_strong) {
      if (!is_strong || whole[j] < 0 || -value <= most) return;
      most = -value;
      of[i] = whole[j];
    });
  }
  return aggregates;
}

/// Carries values of the aggregates to their unknowns and smooths them by one damped step. Weak couplings
/// count as if they were on the diagonal, so that constants stay constant.
SparseRows smoothed_prolongation(const Couplings& couplings, const Aggregates& aggregates) {
  SparseRows prolongation;
  prolongation.columns = static_cast<std::size_t>(aggregates.count);
  const auto add = [&](int column, double value) {
    if (column < 0) return;
    for (std::size_t e = prolongation.start.back(); e < prolongation.column.size(); ++e)
      if (prolongation.column[e] == column) {
        prolongation.value[e] += value;
        return;
      }
    prolongation.column.push_back(column);
    prolongation.value.push_back(value);
  };
  for (std::size_t i = 0; i < couplings.size(); ++i) {
    double diagonal = couplings.diagonal(i), magnitudes = 0;
    couplings.for_each(
        i, [&](int, double value, bool is_strong) { (is_strong ? magnitudes : diagonal) += value; });
    const double step = diagonal > 0 ? damping / (diagonal - magnitudes) : 0;
    add(aggregates.of[i], 1 - step * diagonal);
    couplings.for_each(i, [&](int j, double value, bool is_strong) {
      if (is_strong) add(aggregates.of[j], -step * value);
    });
    prolongation.start.push_back(prolongation.column.size());
  }
  return prolongation;
}

constexpr std::size_t rows_at_once = 32768;  // that one core sweeps

/// The diagonal and the magnitudes of what couples a row to those that are swept elsewhere at the same time.
std::vector<double> sweep_diagonal(const SparseRows& matrix) {
  std::vector<double> diagonal(matrix.rows(), 0);
  for (std::size_t i = 0; i < matrix.rows(); ++i)
    for (std::size_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(matrix.column[e]);
      if (j == i) diagonal[i] += matrix.value[e];
      if (j / rows_at_once != i / rows_at_once) diagonal[i] += std::abs(matrix.value[e]);
    }
  return diagonal;
}

/// The forward sweep from zero: what lies ahead is zero yet.
void sweep_forwards(const SparseRows& matrix, const std::vector<double>& diagonal, const VectorXcd& right,
                    VectorXcd& solution) {
  parallel_ranges(matrix.rows(), rows_at_once, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Vec2 sum = right[static_cast<Eigen::Index>(i)];
      for (std::size_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(matrix.column[e]);
        if (j >= first && j < i) sum -= matrix.value[e] * solution[matrix.column[e]];
      }
      solution[static_cast<Eigen::Index>(i)] = sum / diagonal[i];
    }
  });
}

/// The backward sweep. `before` is the solution before it, by which other ranges are known.
void sweep_backwards(const SparseRows& matrix, const std::vector<double>& diagonal, const VectorXcd& right,
                     const VectorXcd& before, VectorXcd& solution) {
  parallel_ranges(matrix.rows(), rows_at_once, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = last; i-- > first;) {
      Vec2 sum = right[static_cast<Eigen::Index>(i)];
      for (std::size_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(matrix.column[e]);
        sum -= matrix.value[e] * (j >= first && j < last ? solution : before)[matrix.column[e]];
      }
      solution[static_cast<Eigen::Index>(i)] += sum / diagonal[i];
    }
  });
}

}  // namespace

Multigrid::Multigrid(SparseRows matrix) {
  add_level(std::move(matrix));
}

void Multigrid::add_level(SparseRows matrix) {
  const std::size_t fine = matrix.rows();
  const Couplings couplings(matrix, levels_.size());
  Level level;
  level.prolongation = smoothed_prolongation(couplings, aggregate(couplings));
  level.restriction = transpose(level.prolongation);
  SparseRows coarse = multiply(level.restriction, multiply(matrix, level.prolongation));
  level.sweep_diagonal = sweep_diagonal(matrix);
  level.scratch.resize(static_cast<Eigen::Index>(fine));
  level.coarse_right.resize(static_cast<Eigen::Index>(coarse.rows()));
  level.coarse_solution.resize(static_cast<Eigen::Index>(coarse.rows()));
  level.matrix = std::move(matrix);
  levels_.push_back(std::move(level));
  if (coarse.rows() > coarse_enough &&
      static_cast<double>(coarse.rows()) < least_coarsening * static_cast<double>(fine))
    add_level(std::move(coarse));
  else
    factor_coarsest(coarse);
}

void Multigrid::factor_coarsest(const SparseRows& matrix) {
  if (matrix.rows() == 0) return;
  coarsest_.compute(columns_of_symmetric(matrix));
  positive_definite_ = coarsest_.info() == Eigen::Success && (coarsest_.vectorD().array() > 0).all();
}

void Multigrid::cycle(const VectorXcd& right, VectorXcd& solution) {
  cycle(0, right, solution);
}

void Multigrid::cycle(std::size_t depth, const VectorXcd& right, VectorXcd& solution) {
  if (depth == levels_.size()) {
    if (right.size() > 0) solution = coarsest_.solve(right);
    return;
  }
  Level& level = levels_[depth];
  sweep_forwards(level.matrix, level.sweep_diagonal, right, solution);
  VectorXcd& residual = level.scratch;
  residual = right;
  add_product(level.matrix, solution, -1, residual);
  level.coarse_right.setZero();
  add_product(level.restriction, residual, 1, level.coarse_right);
  cycle(depth + 1, level.coarse_right, level.coarse_solution);
  add_product(level.prolongation, level.coarse_solution, 1, solution);
  VectorXcd& before = level.scratch;
  before = solution;
  sweep_backwards(level.matrix, level.sweep_diagonal, right, before, solution);
}

}  // namespace applique
