// Which face owns each texel: one workgroup per job (a triangle over a block). Edge functions in integers, scaled so
// that they are exact; the largest key wins. Foreign triangles and those of other sheets run in a later dispatch and only
// leave their mark.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "transfer_types.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Constants { TransferConstants constants; };
layout(std430, set = 0, binding = 0) buffer Region { uint region[]; };  // Owners, then nearest texels.
layout(std430, set = 0, binding = 1) readonly buffer Jobs { RasterJob jobs[]; };

void main() {
  uint job = constants.first + gl_WorkGroupID.x;
  int x = int(gl_LocalInvocationID.x), y = int(gl_LocalInvocationID.y);
  for (int k = 0; k < 3; ++k) {
    if (jobs[job].a[k] * x + jobs[job].b[k] * y + jobs[job].c[k] < 0) return;
  }
  ivec2 texel = ivec2(x + int(jobs[job].x), y + int(jobs[job].y));
  if (any(greaterThanEqual(texel, constants.region_size))) return;
  uint index = uint(texel.y * constants.region_size.x + texel.x);
  uint key = jobs[job].key;
  if (key == copy_key) {
    if ((atomicOr(region[index], 0u) & key_mask) != 0u) atomicOr(region[index], foreign_bit);
  } else if ((key & key_mask) == 0u) {
    atomicOr(region[index], key);
  } else {
    atomicMax(region[index], key);
  }
}
