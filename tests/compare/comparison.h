#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "applique/decal.h"

#include "compare/layouts.h"
#include "compare/methods.h"
#include "compare/sites.h"

/// The methods side by side: each site with each region and each number of pins, solved by each method and
/// measured by the same code (quality/map_quality.h; §9, §10.1 of the design).
namespace applique::compare {

/// What is solved: "sphere-1.3/disc/5".
struct CaseName {
  std::string site;
  std::string region;
  int pins = 1;

  auto operator<=>(const CaseName&) const = default;
  [[nodiscard]] std::string text() const;
};

struct Case {
  CaseName name;
  std::size_t site = 0;      ///< Index in Comparison::sites.
  Result<DecalInput> input;  ///< Or why the pins could not be placed.
};

/// What is measured of a map; MapQuality says what each is.
struct Figures {
  double l2 = 1;
  double linf = 1;
  double angle = 1;
  double area = 1;
  std::uint32_t flips = 0;        ///< Faces turned over in the image.
  double residual_px = 0;         ///< The largest of the features.
  double coverage = 0;            ///< Of the region's area.
  double surface = 0;             ///< Surface area under the region, scene units squared.
  std::optional<double> seconds;  ///< The solve's; none of what another program did.
};

/// A method's result on a case.
struct Row {
  CaseName name;
  std::string method;
  std::string status = "solved";  ///< Or the sentence that says why not.
  std::optional<Figures> figures;
  std::optional<DecalMap> map;  ///< Kept where a picture is wanted.

  [[nodiscard]] bool solved() const { return figures && status == "solved"; }
};

struct Comparison {
  std::vector<Site> sites;
  std::vector<Layout> layouts;
  std::vector<Case> cases;         ///< By site, region, pins.
  std::vector<Row> rows;           ///< Case by case, in each method by method.
  std::vector<std::string> notes;  ///< Sites that could not be made, and why.

  [[nodiscard]] const Case* find(const std::string& name) const;
};

/// The cases whose name contains `only`, with pins where the default method has them with one pin (pins.h).
Comparison make_cases(const std::vector<SiteSource>& sources, const std::string& only);

/// Solves every case by every method, on all cores. Rows that `pictured` accepts keep their map.
void solve_cases(Comparison& comparison, const std::vector<Contender>& methods,
                 const std::function<bool(const CaseName&)>& pictured);

/// The row of a map that was measured.
Row row_of(const CaseName& name, const std::string& method, const DecalMap& map);

}  // namespace applique::compare
