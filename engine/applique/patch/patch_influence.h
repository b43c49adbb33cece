#pragma once

#include <span>
#include <vector>

#include "applique/patch/growth.h"
#include "applique/patch/immersed_disc.h"
#include "applique/region/influence.h"
#include "applique/region/region.h"

namespace applique {

/// The influence that each vertex of a patch is under, [vertex * groups + group], from where it is in the
/// image: the field's there, for vertices that hang together with a feature inside the region. All others
/// take the mean of neighbours that have theirs: what a place outside the region or far from its neighbours
/// would get from the field may belong to another sheet. Ids are compact.
std::vector<double> influence_on_patch(const ImmersedDisc& disc, const PatchPoints& points,
                                       const Region& region, const InfluenceField& field,
                                       std::span<const PatchFaceId> feature_faces,
                                       std::span<const std::uint32_t> group);

}  // namespace applique
