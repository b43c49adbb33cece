#pragma once

#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

/// Tutte's embedding: boundary on a circle by arc length, the inside by mean value weights (Floater 2003).
/// Turns no triangle over, whatever the disc, up to rounding; distorts a lot. The circle has the disc's area.
std::vector<Vec2> embed_on_circle(const DiscGeometry& disc);

}  // namespace applique
