#include "compare/summary.h"

#include <algorithm>
#include <limits>
#include <map>

namespace applique::compare {
namespace {

constexpr double tie = 1.0001;            // of two L2 stretches
constexpr double whole_tolerance = 0.01;  // of the region's area; more than all of it is shown twice

/// What the methods that solve a case are measured by.
struct Best {
  double l2 = std::numeric_limits<double>::infinity();
  double l2_whole = std::numeric_limits<double>::infinity();
  double coverage = 0;  ///< Of maps without turned faces, at most 1.
};

bool is_whole(const Figures& figures, const Best& best) {
  return figures.flips == 0 && figures.coverage > best.coverage - whole_tolerance &&
         figures.coverage < 1 + whole_tolerance;
}

std::map<CaseName, Best> best_by_case(const std::vector<const Row*>& rows) {
  std::map<CaseName, Best> best;
  for (const Row* row : rows) {
    Best& b = best[row->name];
    b.l2 = std::min(b.l2, row->figures->l2);
    if (row->figures->flips == 0) b.coverage = std::max(b.coverage, std::min(1.0, row->figures->coverage));
  }
  for (const Row* row : rows) {
    Best& b = best[row->name];
    if (is_whole(*row->figures, b)) b.l2_whole = std::min(b.l2_whole, row->figures->l2);
  }
  return best;
}

void add(MethodSummary& summary, const Figures& figures, const Best& best) {
  const bool whole = is_whole(figures, best);
  ++summary.solved;
  summary.least_l2 += figures.l2 <= tie * best.l2;
  summary.whole += whole;
  summary.least_l2_whole += whole && figures.l2 <= tie * best.l2_whole;
  summary.worst_ratio = std::max(summary.worst_ratio, figures.l2 / best.l2);
  summary.flips += figures.flips;
  summary.worst_residual_px = std::max(summary.worst_residual_px, figures.residual_px);
  summary.least_coverage = std::min(summary.least_coverage, figures.coverage);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<MethodSummary> summarise(const std::vector<Row>& rows) {
  std::vector<const Row*> solved;
  for (const Row& row : rows)
    if (row.name.pins > 1 && row.solved()) solved.push_back(&row);
  const std::map<CaseName, Best> best = best_by_case(solved);

  std::vector<MethodSummary> summaries;
  std::map<std::string, std::vector<double>> ratios;
  for (const Row& row : rows) {
    if (row.name.pins < 2) continue;
    auto summary = std::find_if(summaries.begin(), summaries.end(),
                                [&](const MethodSummary& s) { return s.method == row.method; });
    if (summary == summaries.end()) {
      summaries.emplace_back().method = row.method;
      summary = std::prev(summaries.end());
    }
    ++summary->rows;
    if (!row.solved()) continue;
    add(*summary, *row.figures, best.at(row.name));
    ratios[row.method].push_back(row.figures->l2 / best.at(row.name).l2);
  }
  for (MethodSummary& summary : summaries) summary.median_ratio = median(ratios[summary.method]);
  return summaries;
}

}  // namespace applique::compare
