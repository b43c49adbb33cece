#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/SparseCore>

namespace applique {

/// A sparse matrix by rows. Rows are independent of one another, so that what is done row by row runs on all
/// cores and gives the same result on any number of them. Columns within a row are in no order.
struct SparseRows {
  std::size_t columns = 0;
  std::vector<std::size_t> start = {0};  ///< By row, and the end of the last: [rows + 1].
  std::vector<int> column;
  std::vector<double> value;

  [[nodiscard]] std::size_t rows() const { return start.size() - 1; }
};

/// The symmetric matrix whose lower triangle is given; what lies above the diagonal is not looked at.
SparseRows symmetric_rows(const Eigen::SparseMatrix<double>& lower);
/// The whole matrix for Eigen, which wants columns: of a symmetric one they are the rows.
Eigen::SparseMatrix<double> columns_of_symmetric(const SparseRows& matrix);

SparseRows transpose(const SparseRows& matrix);
SparseRows multiply(const SparseRows& left, const SparseRows& right);

/// result += factor * matrix * x, for one or two real vectors x at once, two as one complex vector.
void add_product(const SparseRows& matrix, const Eigen::VectorXcd& x, double factor,
                 Eigen::VectorXcd& result);

}  // namespace applique
