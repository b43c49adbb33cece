// A soft studio: a key with a wrapped edge, a cool fill, a rim, and light from the whole sky; a slight gloss.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "render_types.h"

layout(std140, set = 0, binding = 0) uniform Frame { RenderFrame frame; };
layout(set = 0, binding = 1) uniform sampler2D base_colour;
layout(push_constant) uniform Draw { RenderDraw draw; };
layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec2 texture_place;
layout(location = 0) out vec4 colour;

// Lambert's law with the terminator moved beyond the edge, so that it fades instead of cutting.
float wrapped(vec3 n, vec3 light, float reach) { return max(0.0, (dot(n, light) + reach) / (1.0 + reach)); }

void main() {
  vec4 base = texture(base_colour, texture_place) * draw.base_colour;
  if (draw.alpha_mode == alpha_mask && base.a < draw.cutoff) discard;

  vec3 view = normalize(frame.eye.xyz - world_position);
  vec3 n = world_normal;
  if (dot(n, n) < 1e-12) n = cross(dFdx(world_position), dFdy(world_position));
  n = normalize(n);
  if (!gl_FrontFacing) n = -n;

  float sky = 0.5 + 0.5 * dot(n, frame.up.xyz);
  vec3 diffuse = mix(vec3(0.20, 0.185, 0.175), vec3(0.36, 0.375, 0.40), sky);
  diffuse += vec3(0.66, 0.64, 0.61) * wrapped(n, frame.key.xyz, 0.25);
  diffuse += vec3(0.15, 0.165, 0.19) * wrapped(n, frame.fill.xyz, 0.4);

  float facing = clamp(dot(n, view), 0.0, 1.0);
  float fresnel = 0.04 + 0.96 * pow(1.0 - facing, 5.0);
  float gloss = pow(max(0.0, dot(n, normalize(view + frame.key.xyz))), 48.0);
  float edge = pow(1.0 - facing, 3.0) * wrapped(n, frame.rim.xyz, 0.1);
  vec3 specular = vec3(0.10 * gloss + 0.22 * edge) + vec3(0.12, 0.125, 0.13) * fresnel * sky;

  float alpha = draw.alpha_mode == alpha_blend ? base.a : 1.0;
  colour = vec4((base.rgb * diffuse + specular) * alpha, alpha);  // Premultiplied.
}
