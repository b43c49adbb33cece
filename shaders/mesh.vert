#version 450
#extension GL_GOOGLE_include_directive : require
#include "render_types.h"

layout(std140, set = 0, binding = 0) uniform Frame { RenderFrame frame; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
layout(location = 2) out vec2 texture_place;

void main() {
  world_position = position;
  world_normal = normal;
  texture_place = uv;
  gl_Position = frame.view_projection * vec4(position, 1.0);
}
