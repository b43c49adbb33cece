#pragma once

#include <span>

#include "applique/embed/disc_geometry.h"

namespace applique {

/// The first time in (0, 1] at which a triangle has no area while all vertices move linearly from `start`,
/// which turns nothing over, to `goal`; 2 if none has.
double first_collapse(const DiscGeometry& disc, std::span<const Vec2> start, std::span<const Vec2> goal);

}  // namespace applique
