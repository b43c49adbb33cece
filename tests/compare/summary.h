#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/comparison.h"

namespace applique::compare {

/// How a method did over the rows with two or more pins. Of a case, the methods that solve it are compared.
/// A map is *whole* when it turns no face over and shows the region once, to 1 % as far as the best map
/// without turned faces does; the others may have a small stretch because they leave faces out.
struct MethodSummary {
  std::string method;
  int rows = 0;
  int solved = 0;
  int least_l2 = 0;              ///< Rows in which it has the least L2, to 0.01 %: ties count for each.
  int whole = 0;                 ///< Rows in which its map is whole.
  int least_l2_whole = 0;        ///< Rows in which it is whole and has the least L2 of the whole maps.
  double median_ratio = 0;       ///< Its L2 to the least of the row; 0 if it solves none.
  double worst_ratio = 0;        ///< The largest of these.
  std::uint64_t flips = 0;       ///< Of all rows.
  double worst_residual_px = 0;  ///< Of all features of all rows.
  double least_coverage = 1;
};

/// By method, in the order in which they first come.
std::vector<MethodSummary> summarise(const std::vector<Row>& rows);

}  // namespace applique::compare
