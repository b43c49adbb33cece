#pragma once

#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

/// Places the free vertices at the mean value coordinates of their neighbours (Floater 2003), all others
/// staying where they are in `plane`. Turns no triangle over between them when the fixed vertices round them
/// form a convex polygon. Cost follows the free vertices, but for one pass over the faces.
void place_by_mean_value(const DiscGeometry& disc, const std::vector<char>& free, std::vector<Vec2>& plane);

/// Tutte's embedding: boundary on a circle by arc length, the inside by mean value coordinates. Turns no
/// triangle over, whatever the disc, up to rounding; distorts a lot. The circle has the disc's area.
std::vector<Vec2> embed_on_circle(const DiscGeometry& disc);

}  // namespace applique
