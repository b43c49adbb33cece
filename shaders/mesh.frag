// A soft studio: a key with a wrapped edge, a cool fill, a rim, and light from the whole sky; a slight gloss.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "render_types.h"

layout(std140, set = 0, binding = 0) uniform Frame { RenderFrame frame; };
layout(set = 0, binding = 1) uniform sampler2D base_colour;
layout(set = 0, binding = 2) uniform sampler2D metallic_roughness;
layout(set = 0, binding = 3) uniform sampler2D relief;
layout(set = 0, binding = 4) uniform sampler2D emissive;
layout(push_constant) uniform Draw { RenderDraw draw; };
layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec2 texture_place;
layout(location = 0) out vec4 colour;

// Lambert's law with the terminator moved beyond the edge, so that it fades instead of cutting.
float wrapped(vec3 n, vec3 light, float reach) { return max(0.0, (dot(n, light) + reach) / (1.0 + reach)); }

// The normal map's vector in the frame that glTF prescribes: the tangent along the texture's u, the bitangent at a
// right angle to it, on the side against v, which points down.
vec3 with_relief(vec3 n) {
  vec3 px = dFdx(world_position), py = dFdy(world_position);
  vec2 ux = dFdx(texture_place), uy = dFdy(texture_place);
  float side = ux.x * uy.y - uy.x * ux.y < 0.0 ? -1.0 : 1.0;
  vec3 along_u = side * (px * uy.y - py * ux.y), along_v = side * (py * ux.x - px * uy.x);
  along_u -= n * dot(n, along_u);
  if (dot(along_u, along_u) <= 0.0) return n;
  vec3 tangent = normalize(along_u), bitangent = cross(n, tangent);
  if (dot(bitangent, along_v) > 0.0) bitangent = -bitangent;
  vec3 stored = 2.0 * texture(relief, texture_place).xyz - 1.0;
  stored.xy *= draw.normal_scale;
  return normalize(tangent * stored.x + bitangent * stored.y + n * stored.z);
}

void main() {
  vec4 base = texture(base_colour, texture_place) * draw.base_colour;
  if (draw.alpha_mode == alpha_mask && base.a < draw.cutoff) discard;

  vec3 view = normalize(frame.eye.xyz - world_position);
  vec3 n = world_normal;
  bool flat_face = dot(n, n) < 1e-12;
  if (flat_face) n = cross(dFdx(world_position), dFdy(world_position));
  n = normalize(n);
  if (flat_face ? dot(n, view) < 0.0 : !gl_FrontFacing) n = -n;
  if (draw.normal_scale > 0.0) n = with_relief(n);

  vec2 material = texture(metallic_roughness, texture_place).bg * vec2(draw.metallic, draw.roughness);
  float metal = material.x, rough = clamp(material.y, 0.15, 1.0);
  float sky = 0.5 + 0.5 * dot(n, frame.up.xyz);
  vec3 diffuse = mix(vec3(0.20, 0.185, 0.175), vec3(0.36, 0.375, 0.40), sky);
  diffuse += vec3(0.66, 0.64, 0.61) * wrapped(n, frame.key.xyz, 0.25);
  diffuse += vec3(0.15, 0.165, 0.19) * wrapped(n, frame.fill.xyz, 0.4);

  float facing = clamp(dot(n, view), 0.0, 1.0);
  float fresnel = 0.04 + 0.96 * pow(1.0 - facing, 5.0);
  float exponent = 2.0 / (rough * rough * rough * rough) - 2.0;
  float gloss = pow(max(1e-6, dot(n, normalize(view + frame.key.xyz))), exponent) * min(0.02 * (exponent + 2.0), 8.0);
  float edge = pow(1.0 - facing, 3.0) * wrapped(n, frame.rim.xyz, 0.1);
  vec3 specular = vec3(0.10 * gloss + 0.22 * edge) + vec3(0.12, 0.125, 0.13) * fresnel * sky;

  // Metals show their surroundings, here the sky and the ground, in their own colour: the rougher, the wider spread,
  // in the end as matt surfaces do.
  float mirrored = smoothstep(-0.2 - 0.6 * rough, 0.2 + 0.6 * rough, dot(reflect(-view, n), frame.up.xyz));
  vec3 around = mix(vec3(0.18, 0.17, 0.16), vec3(0.85, 0.88, 0.92), mirrored) + 0.8 * gloss;
  around = mix(around, diffuse, rough * rough);
  vec3 lit = mix(base.rgb * diffuse + specular, base.rgb * around + 0.1 * specular, metal);
  lit += draw.emissive.rgb * texture(emissive, texture_place).rgb;

  float alpha = draw.alpha_mode == alpha_blend ? base.a : 1.0;
  colour = vec4(lit * alpha, alpha);  // Premultiplied.
}
