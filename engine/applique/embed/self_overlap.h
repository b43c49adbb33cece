#pragma once

#include "applique/patch/growth.h"
#include "applique/patch/immersed_disc.h"
#include "applique/region/region.h"

namespace applique {

/// Whether the part of a disc whose vertices lie in the region lies over itself in the plane: its outline
/// there crosses itself at places that are far apart in the image. Crossings of what lies close together in
/// the image are folds, and no business of this.
bool overlaps_in_plane(const ImmersedDisc& disc, const PatchPoints& points, const Region& region);

/// Whether the embedding of some of a disc's faces, which hang together, is seen at once to be injective:
/// none is turned over and their outline does not cross itself. Simple outlines of an immersion go round it
/// once, so that nothing can lie over anything.
bool is_injective(const ImmersedDisc& disc, const PatchPoints& points,
                  const IdVector<PatchFaceId, char>& among);

}  // namespace applique
