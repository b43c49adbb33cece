#include "compare/tables.h"

#include <fmt/format.h>

#include "compare/summary.h"

namespace applique::compare {
namespace {

/// "-" for a method that solves none.
std::string of_solved(const MethodSummary& summary, const std::string& text) {
  return summary.solved > 0 ? text : "-";
}

/// Nothing for what another program did.
std::string seconds_of(const Figures& figures) {
  return figures.seconds ? fmt::format("{:.3f}", *figures.seconds) : "";
}

std::vector<std::string> rounded(const Row& row) {
  std::vector<std::string> cells = {row.name.region, std::to_string(row.name.pins), row.method};
  if (row.figures) {
    const Figures& f = *row.figures;
    cells.insert(
        cells.end(),
        {fmt::format("{:.4f}", f.l2), fmt::format("{:.3g}", f.linf), fmt::format("{:.4f}", f.angle),
         fmt::format("{:.4f}", f.area), std::to_string(f.flips), fmt::format("{:.2g}", f.residual_px),
         fmt::format("{:.1f} %", 100 * f.coverage), fmt::format("{:.4g}", f.surface), seconds_of(f)});
  } else {
    cells.insert(cells.end(), 9, "");
  }
  cells.push_back(row.status);
  return cells;
}

}  // namespace

TextTable summary_table(const std::vector<Row>& rows) {
  TextTable table{{"method", "solved", "least L2", "whole", "least L2 of whole", "median L2 / least", "worst",
                   "flips", "worst residual (px)", "least coverage"},
                  {}};
  for (const MethodSummary& s : summarise(rows))
    table.rows.push_back({s.method, fmt::format("{} of {}", s.solved, s.rows), std::to_string(s.least_l2),
                          std::to_string(s.whole), std::to_string(s.least_l2_whole),
                          of_solved(s, fmt::format("{:.4f}", s.median_ratio)),
                          of_solved(s, fmt::format("{:.4g}", s.worst_ratio)), std::to_string(s.flips),
                          of_solved(s, fmt::format("{:.2g}", s.worst_residual_px)),
                          of_solved(s, fmt::format("{:.1f} %", 100 * s.least_coverage))});
  return table;
}

TextTable full_table(const std::vector<Row>& rows) {
  TextTable table{{"surface", "region", "features", "method", "l2", "linf", "angle", "area", "flips",
                   "residual_px", "coverage", "surface_area", "seconds", "status"},
                  {}};
  for (const Row& row : rows) {
    std::vector<std::string> cells = {row.name.site, row.name.region, std::to_string(row.name.pins),
                                      row.method};
    if (row.figures) {
      const Figures& f = *row.figures;
      for (const double value : {f.l2, f.linf, f.angle, f.area}) cells.push_back(fmt::format("{}", value));
      cells.push_back(std::to_string(f.flips));
      for (const double value : {f.residual_px, f.coverage, f.surface})
        cells.push_back(fmt::format("{}", value));
      cells.push_back(seconds_of(f));
    } else {
      cells.insert(cells.end(), 9, "");
    }
    cells.push_back(row.status);
    table.rows.push_back(std::move(cells));
  }
  return table;
}

TextTable site_table(const std::vector<Row>& rows, const std::string& site) {
  TextTable table{{"region", "features", "method", "L2", "Linf", "angle", "area", "flips", "residual (px)",
                   "coverage", "surface area", "s", "status"},
                  {}};
  for (const Row& row : rows)
    if (row.name.site == site) table.rows.push_back(rounded(row));
  return table;
}

std::vector<std::string> explanations() {
  return {
      R"(Each row is one method on one surface, region and number of features; all are measured by the same code
(engine/applique/quality/map_quality.h). L2 and Linf are the stretch of Sander et al. 2001, normalised so that an
isometry up to scale has 1; angle and area are the area means of s1/s2 and of max(s1 s2, 1/(s1 s2)); flips are
faces turned over in the image, which the means leave out; the residual is the largest distance of a feature from
its pixel in an image of 512 x 512; coverage is the share of the region that lands on the surface; surface area is what shows the image, in the
model's units squared: a map that shows all of the image on a smaller part of the surface leaves out what bends most. Seconds are the
solve's, taken while every core is busy: they are printed, not judged.)",
      R"(Features lie where someone would put them who wants the picture undistorted: at the surface points where the
default method (isometric) has their image points when it is given the first one alone, with the size named below
each surface. That is the default's own choice of places; no other method is asked for its own. The first feature is
in the middle of the region; methods that meet only that one are turned and scaled about it to come nearest to the
others. The paper's method pins vertices, so that its residual is up to the length of an edge.
Other programs' rows are on the patch of the default's solution: what their map would need beyond it is missing from
their coverage.)",
      R"(The summary is over the rows with two or more features. "Least L2" counts the rows in which no method that
solves them has less, to 0.01 %, so that ties count for each. A map is "whole" when it turns nothing over and shows
the region once, to 1 % as far as the best such map; the others leave out the faces that cost the most, so that L2
flatters them. All ratios are within a row of this run.)",
  };
}

std::string to_markdown(const Comparison& comparison, const std::vector<SiteSource>& sources) {
  std::string text = "# Comparison\n\n" + to_markdown(summary_table(comparison.rows)) + "\n";
  for (const std::string& note : comparison.notes) text += note + "\n\n";
  for (const std::string& paragraph : explanations()) text += paragraph + "\n\n";
  for (const SiteSource& source : sources) {
    const TextTable table = site_table(comparison.rows, source.name);
    if (!table.rows.empty())
      text += fmt::format("## {}\n\n{}\n\n{}\n", source.name, source.about, to_markdown(table));
  }
  return text;
}

}  // namespace applique::compare
