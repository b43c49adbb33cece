#pragma once

#include "applique/decal.h"

namespace applique {

/// A square image with five features over most of `shapes::hills`, of any number of cells.
DecalInput hills_decal(const SurfaceMesh& hills);

}  // namespace applique
