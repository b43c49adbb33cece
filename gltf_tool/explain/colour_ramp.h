#pragma once

#include <span>

#include "applique/image/draw.h"

namespace applique {

/// A colour by lightness (0..1), green to red, blue to yellow: even steps look even (Ottosson 2020).
struct OkLab {
  double lightness, a, b;
};

/// sRGB, clipped to what it can show.
draw::Rgba to_srgb(const OkLab& colour);

/// The colour at t in [0, 1] between control points at even distances; t beyond is clamped.
draw::Rgba ramp_colour(std::span<const OkLab> ramp, double t);

}  // namespace applique
