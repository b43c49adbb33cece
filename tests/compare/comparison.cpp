#include "compare/comparison.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "applique/base/parallel.h"

#include "compare/pins.h"

namespace applique::compare {
namespace {

/// A site's region, whose pins its one-pin map places.
struct Place {
  std::size_t site;
  const Layout* layout;
};

std::vector<Case> cases_of(const Comparison& comparison, const Place& place, const std::string& only) {
  const Site& site = comparison.sites[place.site];
  const DecalInput lone = one_pin(site, *place.layout, site.name + "/" + place.layout->name);
  const Result<DecalMap> base = solve_decal(site.mesh, lone);
  std::vector<Case> cases;
  for (const int count : pin_counts) {
    const CaseName name{site.name, place.layout->name, count};
    if (name.text().find(only) == std::string::npos) continue;
    Result<DecalInput> input = lone;
    input->name = name.text();
    if (count > 1) {
      auto pins = base ? pins_of_map(*base, *place.layout, count) : tl::unexpected(base.error());
      if (pins)
        input->features = std::move(*pins);
      else
        input = tl::unexpected(std::move(pins.error()));
    }
    cases.push_back({name, place.site, std::move(input)});
  }
  return cases;
}

bool any_case_matches(const std::string& site, const Layout& layout, const std::string& only) {
  return std::any_of(pin_counts.begin(), pin_counts.end(), [&](int count) {
    return CaseName{site, layout.name, count}.text().find(only) != std::string::npos;
  });
}

Row solve(const Case& solved, const Site& site, const Contender& method, bool keep_map) {
  if (!solved.input) return {solved.name, method.name, solved.input.error().message, {}, {}};
  Result<DecalMap> map = solve_decal(site.mesh, *solved.input, method.options);
  if (!map) return {solved.name, method.name, map.error().message, {}, {}};
  Row row = row_of(solved.name, method.name, *map);
  if (keep_map) row.map = std::move(*map);
  return row;
}

}  // namespace

std::string CaseName::text() const {
  return fmt::format("{}/{}/{}", site, region, pins);
}

const Case* Comparison::find(const std::string& name) const {
  const auto found =
      std::find_if(cases.begin(), cases.end(), [&](const Case& c) { return c.name.text() == name; });
  return found == cases.end() ? nullptr : &*found;
}

Row row_of(const CaseName& name, const std::string& method, const DecalMap& map) {
  const MapQuality& quality = map.quality;
  const auto worst = std::max_element(quality.feature_residual.begin(), quality.feature_residual.end());
  Row row{name, method, "solved", {}, {}};
  row.figures = {
      quality.l2_stretch,      quality.linf_stretch,  quality.angle_distortion,
      quality.area_distortion, quality.flipped_image, worst == quality.feature_residual.end() ? 0 : *worst,
      quality.coverage,        quality.area,          map.times.total};
  if (map.status == Coverage::not_converged)
    row.status = fmt::format("stopped after {} embeddings, the region not yet covered", map.solves);
  return row;
}

Comparison make_cases(const std::vector<SiteSource>& sources, const std::string& only) {
  Comparison comparison;
  comparison.layouts = all_layouts();
  std::vector<Place> places;
  for (const SiteSource& source : sources) {
    std::vector<const Layout*> wanted;
    for (const Layout& layout : comparison.layouts)
      if (any_case_matches(source.name, layout, only)) wanted.push_back(&layout);
    if (wanted.empty()) continue;
    Result<Site> site = source.make();
    if (!site) {
      comparison.notes.push_back(site.error().message);
      continue;
    }
    for (const Layout* layout : wanted) places.push_back({comparison.sites.size(), layout});
    comparison.sites.push_back(std::move(*site));
  }
  std::vector<std::vector<Case>> made(places.size());
  parallel_for(static_cast<int>(places.size()), [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    made[k] = cases_of(comparison, places[k], only);
  });
  for (std::vector<Case>& cases : made)
    std::move(cases.begin(), cases.end(), std::back_inserter(comparison.cases));
  return comparison;
}

void solve_cases(Comparison& comparison, const std::vector<Contender>& methods,
                 const std::function<bool(const CaseName&)>& pictured) {
  comparison.rows.resize(comparison.cases.size() * methods.size());
  parallel_for(static_cast<int>(comparison.rows.size()), [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    const Case& solved = comparison.cases[k / methods.size()];
    comparison.rows[k] =
        solve(solved, comparison.sites[solved.site], methods[k % methods.size()], pictured(solved.name));
  });
}

}  // namespace applique::compare
