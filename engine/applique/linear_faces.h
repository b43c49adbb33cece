#pragma once

#include <span>

#include "applique/decal.h"

namespace applique {

/// For each face of the patch, whether the linear map stands for the warp: when the warp at its edges'
/// middles and its centroid agrees with interpolation, and no feature lies in it (§5.1 of the design).
/// `tolerance` in plane units. Looks at all of the map but `linear`.
IdVector<PatchFaceId, char> linear_faces(const DecalMap& map, double tolerance,
                                         std::span<const PatchFaceId> feature_faces);

}  // namespace applique
