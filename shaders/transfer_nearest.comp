// The nearest owned texel of each texel along its row, up to `gutter` away, the left one of two. The shading pass
// looks along the columns of this: together an exact nearest texel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "transfer_types.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Constants { TransferConstants constants; };
layout(std430, set = 0, binding = 0) buffer Region { uint region[]; };  // Owners, then nearest texels.
layout(std430, set = 0, binding = 1) readonly buffer Blocks { uint blocks[]; };

void main() {
  uint block = blocks[constants.first + gl_WorkGroupID.x];
  ivec2 texel = ivec2(gl_LocalInvocationID.xy + block_size * uvec2(block & 0xffffu, block >> 16));
  if (any(greaterThanEqual(texel, constants.region_size))) return;
  int row = texel.y * constants.region_size.x;
  int distance = int(no_texel);
  for (int i = 0; i <= 2 * constants.gutter; ++i) {
    int dx = (i & 1) == 0 ? i / 2 : -(i + 1) / 2;
    int x = texel.x + dx;
    if (x >= 0 && x < constants.region_size.x && region[row + x] != 0u) {
      distance = dx;
      break;
    }
  }
  region[constants.region_size.x * constants.region_size.y + row + texel.x] = uint(distance);
}
