#pragma once

#include <cstddef>

#include "applique/image/draw.h"

namespace applique {

/// Writes a whole number around `centre`, `height` pixels high, in strokes a seventh as wide.
void draw_number(draw::Canvas& canvas, std::size_t number, Vec2 centre, double height,
                 const draw::Paint& paint);

/// Writes a number with two decimals to the right of `start`, the middle of its left edge.
void draw_decimal(draw::Canvas& canvas, double number, Vec2 start, double height, const draw::Paint& paint);

}  // namespace applique
