#include "applique/base/sparse_rows.h"

#include <algorithm>
#include <numeric>

#include "applique/base/parallel.h"
#include "applique/base/types.h"

namespace applique {
namespace {

constexpr std::size_t rows_at_once = 32768;  // worth a thread

/// Lays the entries out by row. `visit(emit)` calls emit(row, column, value) for each, and is called twice.
template <class Visit>
SparseRows collect(std::size_t rows, std::size_t columns, const Visit& visit) {
  SparseRows matrix;
  matrix.columns = columns;
  matrix.start.assign(rows + 1, 0);
  visit([&](std::size_t row, std::size_t, double) { ++matrix.start[row + 1]; });
  std::partial_sum(matrix.start.begin(), matrix.start.end(), matrix.start.begin());
  matrix.column.resize(matrix.start.back());
  matrix.value.resize(matrix.start.back());
  std::vector<std::size_t> end(matrix.start.begin(), matrix.start.end() - 1);
  visit([&](std::size_t row, std::size_t column, double value) {
    const std::size_t at = end[row]++;
    matrix.column[at] = static_cast<int>(column);
    matrix.value[at] = value;
  });
  return matrix;
}

/// One row of a product at a time (Gustavson 1978): sums by column, and which columns there are.
class RowSum {
 public:
  explicit RowSum(std::size_t columns) : place_(columns, -1) {}

  void add_row(const SparseRows& matrix, std::size_t row, double factor) {
    for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
      int& place = place_[matrix.column[e]];
      if (place < 0) {
        place = static_cast<int>(columns_.size());
        columns_.push_back(matrix.column[e]);
        sums_.push_back(0);
      }
      sums_[place] += factor * matrix.value[e];
    }
  }

  void move_to(std::vector<int>& columns, std::vector<double>& values) {
    columns.insert(columns.end(), columns_.begin(), columns_.end());
    values.insert(values.end(), sums_.begin(), sums_.end());
    for (const int column : columns_) place_[column] = -1;
    columns_.clear();
    sums_.clear();
  }

  [[nodiscard]] std::size_t size() const { return columns_.size(); }

 private:
  std::vector<int> place_;  // by column: in columns_ and sums_; -1 where there is nothing
  std::vector<int> columns_;
  std::vector<double> sums_;
};

}  // namespace

SparseRows symmetric_rows(const Eigen::SparseMatrix<double>& lower) {
  const auto size = static_cast<std::size_t>(lower.rows());
  return collect(size, size, [&](const auto& emit) {
    for (Eigen::Index c = 0; c < lower.outerSize(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(lower, c); entry; ++entry) {
        if (entry.row() < c) continue;
        emit(entry.row(), c, entry.value());
        if (entry.row() > c) emit(c, entry.row(), entry.value());
      }
  });
}

Eigen::SparseMatrix<double> columns_of_symmetric(const SparseRows& matrix) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(matrix.value.size());
  for (std::size_t i = 0; i < matrix.rows(); ++i)
    for (std::size_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e)
      entries.emplace_back(matrix.column[e], static_cast<int>(i), matrix.value[e]);
  const auto size = static_cast<Eigen::Index>(matrix.rows());
  Eigen::SparseMatrix<double> columns(size, size);
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

SparseRows transpose(const SparseRows& matrix) {
  return collect(matrix.columns, matrix.rows(), [&](const auto& emit) {
    for (std::size_t row = 0; row < matrix.rows(); ++row)
      for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e)
        emit(matrix.column[e], row, matrix.value[e]);
  });
}

SparseRows multiply(const SparseRows& left, const SparseRows& right) {
  SparseRows product;
  product.columns = right.columns;
  product.start.assign(left.rows() + 1, 0);
  // Each range of rows on its own, and then one after another.
  std::vector<SparseRows> parts((left.rows() + rows_at_once - 1) / rows_at_once);
  parallel_ranges(left.rows(), rows_at_once, [&](std::size_t first, std::size_t last) {
    SparseRows& part = parts[first / rows_at_once];
    RowSum sum(right.columns);
    for (std::size_t row = first; row < last; ++row) {
      for (std::size_t e = left.start[row]; e < left.start[row + 1]; ++e)
        sum.add_row(right, left.column[e], left.value[e]);
      product.start[row + 1] = sum.size();
      sum.move_to(part.column, part.value);
    }
  });
  std::partial_sum(product.start.begin(), product.start.end(), product.start.begin());
  product.column.reserve(product.start.back());
  product.value.reserve(product.start.back());
  for (const SparseRows& part : parts) {
    product.column.insert(product.column.end(), part.column.begin(), part.column.end());
    product.value.insert(product.value.end(), part.value.begin(), part.value.end());
  }
  return product;
}

void add_product(const SparseRows& matrix, const Eigen::VectorXcd& x, double factor,
                 Eigen::VectorXcd& result) {
  parallel_ranges(matrix.rows(), rows_at_once, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      Vec2 sum = 0;
      for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e)
        sum += matrix.value[e] * x[matrix.column[e]];
      result[static_cast<Eigen::Index>(row)] += factor * sum;
    }
  });
}

}  // namespace applique
