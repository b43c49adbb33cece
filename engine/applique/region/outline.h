#pragma once

#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/image/image.h"

namespace applique {

/// The whole image: its four corners.
std::vector<Pixel> rectangle_outline(const Image& image);

/// One simple closed curve around every pixel whose alpha (0..1) is over `threshold`: the outline traced
/// along pixel edges, several islands joined by thin bridges (shortest first), holes ignored; then simplified
/// to at most 0.75 px away from the traced curve and never inward of an opaque pixel. Errors: region_empty.
Result<std::vector<Pixel>> alpha_outline(const Image& image, double threshold);

/// Its first half: the curve along pixel edges, clockwise on the screen. Where two opaque pixels share only a
/// corner, the curve passes it a quarter pixel off, into the transparent pixel.
Result<std::vector<Pixel>> trace_alpha(const Image& image, double threshold);

/// Its second half: leaves out vertices of a traced curve as long as it moves outwards only, by at most
/// `tolerance` px, and stays simple. Expected time O(n).
std::vector<Pixel> simplify_outline(const std::vector<Pixel>& traced, double tolerance);

}  // namespace applique
