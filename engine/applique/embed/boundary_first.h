#pragma once

#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

/// Boundary-first conformal flattening with zero boundary scale factors (Sawhney and Crane 2017; §4.2 of the
/// design): boundary edges keep their lengths, developable discs come out isometric. The paper takes
/// least-squares conformal maps (§5.1), whose result depends on pins and on when the iteration stops; here
/// one factorisation of the interior Laplacian and three solves give the map at once. May turn triangles over
/// on strongly curved discs; values are not finite when the factorisation fails.
std::vector<Vec2> flatten_boundary_first(const DiscGeometry& disc);

}  // namespace applique
