#include "applique/decal_warnings.h"

#include <algorithm>

#include <fmt/format.h>

#include "applique/rivals/rival_solver.h"

namespace applique {
namespace {

constexpr double most_coverage = 1.005;  // beyond it the map overlaps itself
constexpr double high_stretch = 3;

}  // namespace

std::vector<Warning> quality_warnings(const std::string& name, const DecalMap& map,
                                      const SolveOptions& options) {
  std::vector<Warning> warnings;
  const auto add = [&](const char* code, std::string message) {
    warnings.push_back({code, fmt::format("decal '{}': {}", name, message)});
  };
  const double percent = 100 * map.quality.coverage;
  switch (map.status) {
    case Coverage::covered:
      break;
    case Coverage::clipped_by_boundary:
      add("clipped_by_boundary",
          fmt::format("the surface ends inside the region; {:.2f} % of it is shown", percent));
      break;
    case Coverage::clipped_by_cover:
      add("clipped_by_cover",
          fmt::format("the region meets itself on the surface and stops there; {:.2f} % of it is shown{}",
                      percent,
                      options.overlap == Overlap::stop && !is_rival(options.method)
                          ? "; \"overlap\": \"allow\" on the decal lets it go on over itself"
                          : ""));
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
                    is_rival(options.method)
                        ? "make it smaller, or leave out \"method\""
                        : "move the features nearer to where the image wants them, or add some"));
  // The exact warp of one sheet cannot: what its triangles' corners measure is then how much it bends.
  const bool one_sheet = map.sheets == 1 && map.groups == 1 && map.warp.steps > 0;
  if (map.quality.coverage > most_coverage && !one_sheet)
    add("overlapping_map",
        fmt::format("parts of the region land on the surface more than once ({:.2f} % in all): the "
                    "{}",
                    percent,
                    is_rival(options.method)
                        ? "map folds; make it smaller, or leave out \"method\""
                        : "features pull the image over itself; check that none are swapped"));
  if (map.quality.l2_stretch > high_stretch)
    add("high_stretch",
        fmt::format("the image is stretched {:.1f} times as much as need be (L2); make it smaller for "
                    "this part of the model, or pin it where it is torn",
                    map.quality.l2_stretch));
  return warnings;
}

}  // namespace applique
