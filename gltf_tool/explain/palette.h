#pragma once

#include <array>
#include <cstddef>

#include "applique/image/draw.h"

#include "explain/colour_ramp.h"

/// The colours of the pictures that explain a job: those of Okabe and Ito (2008), which readers tell apart
/// whatever colours they see.
namespace applique::palette {

inline const draw::Rgba white = {1, 1, 1};
inline const draw::Rgba ink = {0.13, 0.13, 0.15};
inline const draw::Rgba pale = {0.72, 0.74, 0.77};
inline const draw::Rgba blue = {0.0, 0.447, 0.698};
inline const draw::Rgba sky = {0.337, 0.706, 0.914};
inline const draw::Rgba orange = {0.902, 0.624, 0.0};
inline const draw::Rgba vermilion = {0.835, 0.369, 0.0};
inline const draw::Rgba green = {0.0, 0.620, 0.451};
inline const draw::Rgba pink = {0.8, 0.475, 0.655};
inline const draw::Rgba yellow = {0.941, 0.894, 0.259};

/// Of faces that are turned over.
inline const draw::Rgba flipped = {0.90, 0.0, 0.12};

/// From blue by near white to brown: less, as much, more.
inline constexpr std::array<OkLab, 5> diverging = {
    {{0.36, -0.01, -0.14}, {0.68, -0.05, -0.10}, {0.97, 0.0, 0.01}, {0.74, 0.05, 0.12}, {0.40, 0.06, 0.08}}};

/// From near white by green to violet: nothing to much.
inline constexpr std::array<OkLab, 5> rising = {{{0.97, 0.0, 0.01},
                                                 {0.84, -0.08, 0.08},
                                                 {0.65, -0.09, -0.01},
                                                 {0.45, -0.02, -0.11},
                                                 {0.28, 0.06, -0.10}}};

/// Of groups of features.
inline const draw::Rgba& group(std::size_t k) {
  static const std::array<draw::Rgba, 6> colours = {blue, orange, green, pink, sky, yellow};
  return colours[k % colours.size()];
}

}  // namespace applique::palette
