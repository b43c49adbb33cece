#pragma once

#include "applique/base/types.h"

namespace applique {

/// Sign of the area of the triangle a b c: +1 counter-clockwise, -1 clockwise, 0 exactly collinear. A
/// floating-point filter decides nearly always; the rest is computed exactly (Boost.Multiprecision).
int orientation(Vec2 a, Vec2 b, Vec2 c);

/// Sign of the in-circle determinant: +1 when d lies inside the circle through a, b, c (counter-clockwise).
int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

}  // namespace applique
