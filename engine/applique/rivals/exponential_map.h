#pragma once

#include "applique/rivals/rival_map.h"

namespace applique {

/// The discrete exponential map at the anchor (Schmidt et al. 2006; §10.1 of the design): geodesic polar
/// coordinates, spread as geodesic_front.h says; `parents` tells the paper's variant from that of later
/// codes. An anchor inside a face gives its corners their exact coordinates. Errors: those of
/// place_in_image.
Result<RivalMap> map_exponential(const SurfaceMesh& surface, const RivalTask& task,
                                 Parents parents = Parents::upwind);

}  // namespace applique
