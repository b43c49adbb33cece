#pragma once

#include <span>

#include "applique/image/image.h"

namespace applique {

/// An image of floating-point values, row by row: linear light with the primaries of sRGB, alpha multiplied
/// in, as OpenEXR has it. Colours become straight and sRGB-encoded at 16 bits, since a base colour is a share
/// of light: what is over 1 (or infinite) becomes 1, what is under 0 (or no number) becomes 0. Data are
/// clamped only.
Image image_of_floats(int width, int height, int channels, std::span<const float> values, Floats floats);

}  // namespace applique
