#pragma once

#include "applique/rivals/rival_map.h"

namespace applique {

/// The map along a stroke (after Sun et al. 2013, of whom the abstract is what we have; §10.1 of the design):
/// the image's axis (stroke_axis.h) becomes a curve on the surface, a geodesic from feature to feature, and
/// beyond the last straightest geodesics over the rest of the region's length. Across the curve go signed
/// geodesic distances. The faces that the curve crosses give their corners exact coordinates, those of the
/// nearest piece of the curve; from them geodesic_front.h spreads them, upwind.
///
/// Along the curve, lengths between features become those between them in the image; beyond them, and across,
/// the mean scale counts. A translation makes the anchor exact. Error: not_solved where the curve has no
/// length.
Result<RivalMap> map_along_stroke(const SurfaceMesh& surface, const RivalTask& task);

}  // namespace applique
