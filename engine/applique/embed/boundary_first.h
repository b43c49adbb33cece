#pragma once

#include <vector>

#include "applique/base/laplacian_solver.h"
#include "applique/embed/disc_geometry.h"

namespace applique {

/// Boundary-first conformal flattening with zero boundary scale factors (Sawhney and Crane 2017; §4.2 of the
/// design): boundary edges keep their lengths, developable discs come out isometric. The paper takes
/// least-squares conformal maps (§5.1), whose result depends on pins and on when the iteration stops; here
/// one matrix, the interior Laplacian, and three solves with it give the map at once. May turn triangles over
/// on strongly curved discs; values are not finite when the Laplacian cannot be solved.
std::vector<Vec2> flatten_boundary_first(const DiscGeometry& disc,
                                         const LaplacianSolverOptions& solving = {});

}  // namespace applique
