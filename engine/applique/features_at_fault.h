#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "applique/decal.h"
#include "applique/warp/groups.h"

namespace applique {

/// The fewest features, three at most, without which the warp would turn nothing over; empty if none are
/// found. Of each number, those few are tried without which the others lie nearest to where the image has
/// them. `map` folds; `features` are where its embedding has the features, `targets` their image points,
/// `groups` those in which they move the image.
std::vector<std::uint32_t> features_at_fault(const SurfaceMesh& surface, const Region& region,
                                             const DecalMap& map, std::span<const Vec2> features,
                                             std::span<const Vec2> targets, const FeatureGroups& groups);

}  // namespace applique
