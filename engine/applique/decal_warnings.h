#pragma once

#include <string>
#include <vector>

#include "applique/decal.h"

namespace applique {

/// What a person should know of a solved decal, whatever the method: how much of it is shown, and why not all
/// (clipped_by_boundary, clipped_by_cover, clipped_closed, clipped_by_limits, not_converged);
/// flipped_triangles; overlapping_map; high_stretch. `name` is the decal's.
std::vector<Warning> quality_warnings(const std::string& name, const DecalMap& map,
                                      const SolveOptions& options);

}  // namespace applique
