#pragma once

#include <string>
#include <vector>

#include "applique/decal.h"

namespace applique {

/// What a person should know of a solved decal, whatever the method: how much of it is shown, and why not all
/// (clipped_by_boundary, clipped_by_cover, clipped_in_plane, clipped_closed, clipped_by_limits,
/// not_converged);
/// flipped_triangles; overlapping_map; high_stretch. `name` is the decal's.
std::vector<Warning> quality_warnings(const std::string& name, const DecalMap& map,
                                      const SolveOptions& options);

/// A feature_stress for each feature that the warp must scale or turn beyond is_extreme(), or move by more
/// than a quarter of the region's diameter; and for each pair beyond it of features that are not told of
/// already. Ribbons that bend in the plane move by an eighth in good faith, and those that lie over
/// themselves, in groups, by any length: there the way does not count.
std::vector<Warning> stress_warnings(const DecalInput& input, const DecalMap& map);

}  // namespace applique
