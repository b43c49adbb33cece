#pragma once

#include "applique/patch/growth.h"
#include "applique/patch/immersed_disc.h"
#include "applique/region/region.h"

namespace applique {

/// Whether the part of a disc whose vertices lie in the region lies over itself in the plane: its outline
/// there crosses itself at places that are far apart in the image. Crossings of what lies close together in
/// the image are folds, and no business of this.
bool overlaps_in_plane(const ImmersedDisc& disc, const PatchPoints& points, const Region& region);

}  // namespace applique
