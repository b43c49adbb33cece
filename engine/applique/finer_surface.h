#pragma once

#include <memory>

#include "applique/decal.h"
#include "applique/surface/divided_surface.h"

namespace applique {

/// The surface with its triangles cut, where the region may come to lie, until their edges are no longer than
/// a share of the region's width: paths and turns that would share triangles of a coarse model have their own
/// there. None where they are no longer as it is. Not in the design. The features are connected on the
/// surface.
std::shared_ptr<const DividedSurface> finer_surface(const SurfaceMesh& surface, const DecalInput& input,
                                                    double share);

}  // namespace applique
