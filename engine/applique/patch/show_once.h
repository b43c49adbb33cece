#pragma once

#include <vector>

#include "applique/patch/growth.h"
#include "applique/warp/warp.h"

namespace applique {

/// Takes from `shown` the faces in which the decal would land on the surface a second time: an embedding has
/// no flips, but where the surface has tunnels or deep folds it may lie over itself in the plane all the
/// same. Faces are shown outwards from the features, by the way to them in the image, each unless it lies
/// within the region over one that is shown; the image then ends where it would meet itself. Exact predicates
/// decide, in the plane, where triangles are what they are; the warp has one group, and so folds nothing. The
/// features' own faces stay, and those that are turned over. Returns the area in the image of those that were
/// taken, as a share of the region's.
double show_once(const ImmersedDisc& disc, const PatchPoints& points, const Warp& warp, const Region& region,
                 const std::vector<PatchFaceId>& feature_faces, IdVector<PatchFaceId, char>& shown);

}  // namespace applique
