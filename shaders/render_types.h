// What the preview's shaders and the C++ side share.
#ifndef APPLIQUE_RENDER_TYPES_H
#define APPLIQUE_RENDER_TYPES_H

#ifdef __cplusplus
#include <array>
#include <cstddef>
#include <cstdint>
namespace applique::shader {
using uint = std::uint32_t;
using vec4 = std::array<float, 4>;
using mat4 = std::array<float, 16>;  // By columns.
#define APPLIQUE_CONST constexpr
#else
#define APPLIQUE_CONST const
#endif

APPLIQUE_CONST uint alpha_opaque = 0u;
APPLIQUE_CONST uint alpha_mask = 1u;
APPLIQUE_CONST uint alpha_blend = 2u;

// The same for all meshes. Directions are unit vectors of the scene, towards the light.
struct RenderFrame {
  mat4 view_projection;
  vec4 eye;
  vec4 key;
  vec4 fill;
  vec4 rim;
  vec4 up;
  vec4 background_top;  // Linear light.
  vec4 background_bottom;
};

struct RenderDraw {
  vec4 base_colour;  // Factors on the textures, linear light.
  vec4 emissive;
  float cutoff;
  uint alpha_mode;
  float metallic;
  float roughness;
  float normal_scale;  // 0: no relief.
};

#ifdef __cplusplus
static_assert(sizeof(RenderFrame) == 176 && offsetof(RenderFrame, background_bottom) == 160);
static_assert(sizeof(RenderDraw) == 52 && offsetof(RenderDraw, alpha_mode) == 36);
}  // namespace applique::shader
#endif
#undef APPLIQUE_CONST
#endif
