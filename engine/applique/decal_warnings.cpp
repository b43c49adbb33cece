#include "applique/decal_warnings.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "applique/decal_input.h"
#include "applique/rivals/rival_solver.h"

namespace applique {
namespace {

constexpr double high_stretch = 3;
constexpr double far_shift = 0.25;  // of the region's diameter
constexpr double infinite = std::numeric_limits<double>::infinity();

/// "-30 degrees", which the way of a warp may make more than once round.
std::string turn_text(double radians) {
  return fmt::format("{:.0f} degrees{}", radians * 180 / std::numbers::pi,
                     std::abs(radians) > 2 * std::numbers::pi ? " (more than once round)" : "");
}

}  // namespace

std::vector<Warning> quality_warnings(const std::string& name, const DecalMap& map,
                                      const SolveOptions& options) {
  std::vector<Warning> warnings;
  const auto add = [&](const char* code, std::string message) {
    warnings.push_back({code, fmt::format("decal '{}': {}", name, message)});
  };
  const double percent = 100 * (map.quality.coverage - map.quality.doubled);
  switch (map.status) {
    case Coverage::covered:
      break;
    case Coverage::clipped_by_boundary:
      add("clipped_by_boundary",
          fmt::format("the surface ends inside the region; {:.2f} % of it is shown", percent));
      break;
    case Coverage::clipped_by_cover:
      add("clipped_by_cover",
          fmt::format("the region meets itself on the surface and {}; {:.2f} % of it is shown{}",
                      options.overlap == Overlap::stop ? "stops there" : "cannot go on over itself there",
                      percent,
                      options.overlap == Overlap::stop && !is_rival(options.method)
                          ? "; \"overlap\": \"allow\" on the decal lets it go on over itself"
                          : ""));
      break;
    case Coverage::clipped_in_plane:
      add("clipped_in_plane",
          fmt::format("the surface under the region cannot be laid flat beside itself, as over tunnels and "
                      "deep folds; {:.2f} % of it is shown; make it smaller, or pin it",
                      percent));
      break;
    case Coverage::clipped_closed:
      add("clipped_closed",
          fmt::format("the region goes all the way round the surface; {:.2f} % of it is shown", percent));
      break;
    case Coverage::clipped_by_limits:
      add("clipped_by_limits",
          fmt::format(
              "the surface leaves the projection's depth or normal limit inside the region; {:.2f} % of "
              "it is shown",
              percent));
      break;
    case Coverage::not_converged:
      add("not_converged",
          fmt::format("stopped after {} solves; {:.2f} % of the region is shown", map.solves, percent));
      break;
  }
  if (map.quality.flipped_plane + map.quality.flipped_image > 0)
    add("flipped_triangles",
        fmt::format("{} triangles are turned over; {}",
                    std::max(map.quality.flipped_plane, map.quality.flipped_image),
                    is_rival(options.method) ? "make it smaller, or leave out \"method\""
                    : map.quality.feature_residual.size() == 1
                        ? "make it smaller"
                        : "move the features nearer to where the image wants them, or add some"));
  if (map.quality.doubled > hardly_doubled)
    add("overlapping_map",
        fmt::format("parts of the region land on the surface more than once ({:.2f} % in all): the "
                    "{}",
                    100 * map.quality.coverage,
                    is_rival(options.method) ? "map folds; make it smaller, or leave out \"method\""
                    : map.quality.feature_residual.size() == 1
                        ? "surface folds under it; check \"size\""
                        : "features pull the image over itself; check that none are swapped"));
  if (map.quality.l2_stretch > high_stretch)
    add("high_stretch",
        fmt::format("the image is stretched {:.1f} times as much as need be (L2); make it smaller for "
                    "this part of the model, or pin it where it is torn",
                    map.quality.l2_stretch));
  return warnings;
}

std::vector<Warning> stress_warnings(const DecalInput& input, const DecalMap& map) {
  const WarpStress& stress = map.stress;
  const double most_shift = map.groups == 1 ? far_shift * input.region.diameter() : infinite;
  std::vector<Warning> warnings;
  const auto add = [&](const std::string& message) {
    warnings.push_back({"feature_stress", fmt::format("decal '{}': {}", input.name, message)});
  };
  std::vector<char> told(stress.features.size(), 0);
  for (std::size_t k = 0; k < stress.features.size(); ++k) {
    const FeatureStress& feature = stress.features[k];
    told[k] = feature.shift > most_shift || is_extreme(feature.scale, feature.turn);
    if (told[k] != 0)
      add(
          fmt::format("{} has to be moved by {:.0f} px, scaled by {:.2f} and turned by {} against "
                      "its surroundings; check its place, or leave it out",
                      feature_name(input, k), feature.shift * input.region.frame().pixels_per_unit(),
                      feature.scale, turn_text(feature.turn)));
  }
  for (const auto& [pair, scale, turn] : stress.pairs)
    if (is_extreme(scale, turn) && told[pair[0]] == 0 && told[pair[1]] == 0)
      add(
          fmt::format("{} and {} ask for a scale of {:.2f} and a turn of {} against their surroundings; "
                      "check that they are not swapped",
                      feature_name(input, pair[0]), feature_name(input, pair[1]), scale, turn_text(turn)));
  return warnings;
}

}  // namespace applique
