#pragma once

#include "applique/rivals/rival_map.h"

namespace applique {

/// The planar projection of a decal (Lefebvre et al. 2005, whose sprites in an octree are not needed here:
/// §10.1 of the design) on the anchor's tangent plane. Covers the faces that are connected with the anchor's
/// through faces within the limits: all corners within the depth, the normal within its limit. Breadth first,
/// as far as the region's box reaches. Errors: those of place_in_image.
Result<RivalMap> project_planar(const SurfaceMesh& surface, const RivalTask& task,
                                const PlanarLimits& limits = {});

}  // namespace applique
