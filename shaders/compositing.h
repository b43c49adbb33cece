// How a decal's texel is put over a texture's: one text for the shaders and for their double-precision twin
// (with GLM). Colours are in linear light and, but where said otherwise, straight.
#ifndef APPLIQUE_COMPOSITING_H
#define APPLIQUE_COMPOSITING_H

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
namespace applique::compositing {
using real = double;
using uint = std::uint32_t;
using vec2 = glm::dvec2;
using vec3 = glm::dvec3;
using vec4 = glm::dvec4;
using glm::dot;
using glm::normalize;
using std::abs;
using std::max;
using std::min;
using std::sqrt;
#define APPLIQUE_FUNCTION inline
#define APPLIQUE_CONST constexpr
#else
#define real float
#define APPLIQUE_FUNCTION
#define APPLIQUE_CONST const
#endif

// BlendMode.
APPLIQUE_CONST uint blend_normal = 0u;
APPLIQUE_CONST uint blend_multiply = 1u;
APPLIQUE_CONST uint blend_screen = 2u;
APPLIQUE_CONST uint blend_overlay = 3u;
APPLIQUE_CONST uint blend_darken = 4u;
APPLIQUE_CONST uint blend_lighten = 5u;
APPLIQUE_CONST uint blend_color_dodge = 6u;
APPLIQUE_CONST uint blend_color_burn = 7u;
APPLIQUE_CONST uint blend_hard_light = 8u;
APPLIQUE_CONST uint blend_soft_light = 9u;
APPLIQUE_CONST uint blend_difference = 10u;
APPLIQUE_CONST uint blend_exclusion = 11u;
APPLIQUE_CONST uint blend_hue = 12u;
APPLIQUE_CONST uint blend_saturation = 13u;
APPLIQUE_CONST uint blend_color = 14u;
APPLIQUE_CONST uint blend_luminosity = 15u;
APPLIQUE_CONST uint blend_add = 16u;
APPLIQUE_CONST uint blend_erase = 17u;

// W3C Compositing and Blending Level 1, §10.1: one channel of what the source makes of the backdrop.
APPLIQUE_FUNCTION real blend_channel(uint mode, real below, real source) {
  if (mode == blend_multiply) return below * source;
  if (mode == blend_screen) return below + source - below * source;
  if (mode == blend_overlay || mode == blend_hard_light) {
    // Overlay is hard light the other way round.
    real upper = mode == blend_overlay ? below : source;
    real lower = mode == blend_overlay ? source : below;
    real twice = 2.0 * upper;
    return twice <= 1.0 ? lower * twice : lower + (twice - 1.0) - lower * (twice - 1.0);
  }
  if (mode == blend_darken) return min(below, source);
  if (mode == blend_lighten) return max(below, source);
  if (mode == blend_color_dodge) {
    if (below <= 0.0) return 0.0;
    return below >= 1.0 - source ? 1.0 : below / (1.0 - source);
  }
  if (mode == blend_color_burn) {
    if (below >= 1.0) return 1.0;
    return 1.0 - below >= source ? 0.0 : 1.0 - (1.0 - below) / source;
  }
  if (mode == blend_soft_light) {
    if (source <= 0.5) return below - (1.0 - 2.0 * source) * below * (1.0 - below);
    real lit = below <= 0.25 ? ((16.0 * below - 12.0) * below + 4.0) * below : sqrt(below);
    return below + (2.0 * source - 1.0) * (lit - below);
  }
  if (mode == blend_difference) return abs(below - source);
  if (mode == blend_exclusion) return below + source - 2.0 * below * source;
  if (mode == blend_add) return min(1.0, below + source);
  return source;
}

// §10.2: hue, saturation and luminosity.
APPLIQUE_FUNCTION real luminosity_of(vec3 c) {
  return 0.3 * c.x + 0.59 * c.y + 0.11 * c.z;
}
APPLIQUE_FUNCTION real saturation_of(vec3 c) {
  return max(max(c.x, c.y), c.z) - min(min(c.x, c.y), c.z);
}

APPLIQUE_FUNCTION vec3 with_luminosity(vec3 c, real luminosity) {
  c += vec3(luminosity - luminosity_of(c));
  real lowest = min(min(c.x, c.y), c.z);
  real highest = max(max(c.x, c.y), c.z);
  vec3 grey = vec3(luminosity);
  if (lowest < 0.0) c = grey + (c - grey) * (luminosity / (luminosity - lowest));
  if (highest > 1.0) c = grey + (c - grey) * ((1.0 - luminosity) / (highest - luminosity));
  return c;
}

APPLIQUE_FUNCTION vec3 with_saturation(vec3 c, real saturation) {
  real range = saturation_of(c);
  if (range <= 0.0) return vec3(0.0);
  return (c - vec3(min(min(c.x, c.y), c.z))) * (saturation / range);
}

APPLIQUE_FUNCTION vec3 blend_colour(uint mode, vec3 below, vec3 source) {
  if (mode == blend_hue)
    return with_luminosity(with_saturation(source, saturation_of(below)), luminosity_of(below));
  if (mode == blend_saturation)
    return with_luminosity(with_saturation(below, saturation_of(source)), luminosity_of(below));
  if (mode == blend_color) return with_luminosity(source, luminosity_of(below));
  if (mode == blend_luminosity) return with_luminosity(below, luminosity_of(source));
  return vec3(blend_channel(mode, below.x, source.x), blend_channel(mode, below.y, source.y),
              blend_channel(mode, below.z, source.z));
}

// `source` is premultiplied, of some alpha. Where the texture's alpha does not show (`opaque`), colours are
// blended as over an opaque backdrop. Erasing is Porter and Duff's destination out: the colour stays, for
// where it shows still.
APPLIQUE_FUNCTION vec4 composite(uint mode, vec4 source, vec4 below, bool opaque) {
  real alpha = source.w;
  if (mode == blend_erase) return vec4(below.x, below.y, below.z, below.w * (1.0 - alpha));
  real backdrop = opaque ? 1.0 : below.w;
  vec3 below_colour = vec3(below.x, below.y, below.z);
  vec3 premultiplied = vec3(source.x, source.y, source.z);
  // Of a small alpha, rounding may have left a colour over 1.
  vec3 straight = premultiplied / alpha;
  straight = vec3(min(straight.x, 1.0), min(straight.y, 1.0), min(straight.z, 1.0));
  vec3 colour = (1.0 - backdrop) * premultiplied +
                alpha * backdrop * blend_colour(mode, below_colour, straight) +
                (1.0 - alpha) * backdrop * below_colour;
  colour /= alpha + backdrop * (1.0 - alpha);
  return vec4(colour.x, colour.y, colour.z, alpha + below.w * (1.0 - alpha));
}

// A tangent-space normal as a texture stores it, 0 to 1.
APPLIQUE_FUNCTION vec3 normal_of(vec3 stored) {
  vec3 normal = 2.0 * stored - vec3(1.0);
  real length_squared = dot(normal, normal);
  return length_squared > 0.0 ? normal / sqrt(length_squared) : vec3(0.0, 0.0, 1.0);
}

// Puts the decal's normal (`source`: stored, premultiplied) over the texture's (stored). `along` is the
// direction of the image's x in the texture's tangent frame, a unit vector, and `across` that of its y,
// turned by a quarter one way or the other. Blending "normal" goes straight from the one to the other; "add"
// lays the decal's relief onto the texture's by reoriented normal mapping (Barré-Brisebois and Hill 2012).
APPLIQUE_FUNCTION vec4 composite_normal(uint mode, vec4 source, vec4 below, vec2 along, vec2 across) {
  real alpha = source.w;
  vec3 own = normal_of(vec3(source.x, source.y, source.z) / alpha);
  own = vec3(own.x * along.x + own.y * across.x, own.x * along.y + own.y * across.y, own.z);
  vec3 there = normal_of(vec3(below.x, below.y, below.z));
  vec3 result;
  if (mode == blend_add) {
    vec3 relief = normalize((1.0 - alpha) * vec3(0.0, 0.0, 1.0) + alpha * own);
    vec3 t = there + vec3(0.0, 0.0, 1.0);
    vec3 u = vec3(-relief.x, -relief.y, relief.z);
    result = t.z > 0.0 ? t * (dot(t, u) / t.z) - u : relief;
  } else {
    result = (1.0 - alpha) * there + alpha * own;
  }
  real length_squared = dot(result, result);
  result = length_squared > 0.0 ? result / sqrt(length_squared) : own;
  return vec4(0.5 * result.x + 0.5, 0.5 * result.y + 0.5, 0.5 * result.z + 0.5, below.w);
}

#ifdef __cplusplus
}  // namespace applique::compositing
#endif
#undef APPLIQUE_FUNCTION
#undef APPLIQUE_CONST
#endif
