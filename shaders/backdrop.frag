#version 450
#extension GL_GOOGLE_include_directive : require
#include "render_types.h"

layout(std140, set = 0, binding = 0) uniform Frame { RenderFrame frame; };
layout(location = 0) in vec2 place;
layout(location = 0) out vec4 colour;

void main() {
  vec3 gradient = mix(frame.background_top.rgb, frame.background_bottom.rgb, smoothstep(0.0, 1.0, place.y));
  // Interleaved gradient noise of less than a step of 8 bits: the gradient shows no bands.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  colour = vec4(gradient * (1.0 + (noise - 0.5) / 100.0), 1.0);
}
