#include "compare/summary.h"

#include <algorithm>
#include <limits>
#include <map>

namespace applique::compare {
namespace {

constexpr double tie = 1.0001;              // of two L2 stretches
constexpr double coverage_of_whole = 0.99;  // of the best coverage

/// What the methods that solve a case are measured by.
struct Best {
  double l2 = std::numeric_limits<double>::infinity();
  double l2_whole = std::numeric_limits<double>::infinity();
  double coverage = 0;
};

bool is_whole(const Figures& figures, const Best& best) {
  return figures.flips == 0 && figures.coverage >= coverage_of_whole * best.coverage;
}

std::map<CaseName, Best> best_by_case(const std::vector<const Row*>& rows) {
  std::map<CaseName, Best> best;
  for (const Row* row : rows) {
    Best& b = best[row->name];
    b.l2 = std::min(b.l2, row->figures->l2);
    b.coverage = std::max(b.coverage, row->figures->coverage);
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

}  // namespace

std::vector<MethodSummary> summarise(const std::vector<Row>& rows) {
  std::vector<const Row*> solved;
  for (const Row& row : rows)
    if (row.name.pins > 1 && row.solved()) solved.push_back(&row);
  const std::map<CaseName, Best> best = best_by_case(solved);

  std::vector<MethodSummary> summaries;
  for (const Row& row : rows) {
    if (row.name.pins < 2) continue;
    auto summary = std::find_if(summaries.begin(), summaries.end(),
                                [&](const MethodSummary& s) { return s.method == row.method; });
    if (summary == summaries.end()) {
      summaries.emplace_back().method = row.method;
      summary = std::prev(summaries.end());
    }
    ++summary->rows;
    if (row.solved()) add(*summary, *row.figures, best.at(row.name));
  }
  return summaries;
}

}  // namespace applique::compare
