// Colours the texels that a face owns, and those of the gutter by extending the nearest face: texel -> plane or
// image by the face's affine map, plane -> image by the warp, a filtered sample of the image, blended over the texel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "compositing.h"
#include "transfer_types.h"

layout(local_size_x = 8, local_size_y = 8) in;
// Without them the code of the warp, and that of its groups, is compiled away.
layout(constant_id = 0) const bool has_warp = false;
layout(constant_id = 1) const uint groups = 1u;

layout(push_constant) uniform Constants { TransferConstants constants; };
// Four storage buffers are all that every device has for a shader.
layout(std430, set = 0, binding = 0) readonly buffer Region { uint region[]; };  // Owners, then nearest texels.
layout(std430, set = 0, binding = 1) readonly buffer Plan { uvec4 plan[]; };       // Blocks, faces, points, a large warp's table.
layout(std430, set = 0, binding = 2) readonly buffer Decal { uvec2 decal[]; };     // Premultiplied, half floats.
layout(std430, set = 0, binding = 3) buffer Work {
  uint covered;
  uint gutter;
  uint shared_texels;
  uint padding;
  uvec2 work_words[];  // RGBA of the work's texels, 16 bits each; their samples; the sums of the pieces so far.
};
layout(std140, set = 0, binding = 4) uniform Tables {
  uvec4 levels[max_levels];  // Offset in `decal`, width, height.
#ifndef LARGE_WARP
  vec4 small_warp_table[warp_table_capacity];
#endif
};

uint block_at(uint index) { return plan[index / 4u][index % 4u]; }

FaceMap face_at(uint index) {
  uint first = constants.plan_faces + 5u * index;
  uvec4 a = plan[first], b = plan[first + 1u], c = plan[first + 2u], d = plan[first + 3u], e = plan[first + 4u];
  return FaceMap(ivec2(a.xy), ivec2(a.zw), uintBitsToFloat(b.xy), uintBitsToFloat(b.zw), uintBitsToFloat(c.xy),
                 uintBitsToFloat(c.zw), uintBitsToFloat(d.xy), d.zw, e.x, e.y, e.z, e.w);
}

// Of the faces' grids.
vec2 point_at(uint index) {
  uvec4 pair = plan[constants.plan_points + index / 2u];
  return uintBitsToFloat((index & 1u) == 0u ? pair.xy : pair.zw);
}

// Pairs as (i, j), then by stage the features' (position, group), then by stage the pairs' (lambda, offset).
vec4 warp_table(uint index) {
#ifdef LARGE_WARP
  return uintBitsToFloat(plan[constants.plan_warp + index]);
#else
  return small_warp_table[index];
#endif
}

vec2 complex_product(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

float shares[groups];  // By group: its influence at the texel, ramped.

// As influence_ramp in warp.cpp.
float influence_ramp(float influence) {
  float threshold = min(0.05, 0.5 / float(groups));
  return smoothstep(threshold, 1.0 - threshold, influence);
}

// Squared distance to a feature, divided by its share: out of reach where it has none, but of a square that is finite.
float remoteness(vec2 p, uint feature) {
  vec2 d = p - warp_table(feature).xy;
  float squared = dot(d, d);
  if (groups > 1u) {
    const float out_of_reach = 1e18;
    float share = shares[floatBitsToUint(warp_table(feature).z)];
    return share > 0.0 ? min(squared / share, out_of_reach) : out_of_reach;
  }
  return squared;
}

// Design §5.2; weights as in warp.cpp.
vec2 velocity(vec2 p, uint stage) {
  uint positions = constants.pairs + stage * constants.features;
  uint rates = constants.pairs + 3u * constants.steps * constants.features + stage * constants.pairs;
  uint nearest_feature = 0u;
  float nearest_squared = 0.0;
  for (uint k = 0u; k < constants.features; ++k) {
    float squared = remoteness(p, positions + k);
    if (k == 0u || squared < nearest_squared) {
      nearest_feature = k;
      nearest_squared = squared;
    }
  }
  vec4 sum = vec4(0.0);
  float total = 0.0;
  for (uint q = 0u; q < constants.pairs; ++q) {
    uvec2 pair = floatBitsToUint(warp_table(q).xy);
    float si = remoteness(p, positions + pair.x), sj = remoteness(p, positions + pair.y);
    float weight = pair.x == nearest_feature   ? 1.0 / sj
                   : pair.y == nearest_feature ? 1.0 / si
                                               : nearest_squared / (si * sj);
    sum += weight * warp_table(rates + q);
    total += weight;
  }
  sum /= total;
  return complex_product(sum.xy, p) + sum.zw;
}

// Classical Runge-Kutta; the four slopes of a step share one copy of the field's code.
vec2 warp(vec2 p) {
  float h = 1.0 / float(constants.steps);
  for (uint step = 0u; step < constants.steps; ++step) {
    vec2 slope = vec2(0.0), sum = vec2(0.0);
    for (uint k = 0u; k < 4u; ++k) {
      float reach = k == 0u ? 0.0 : k == 3u ? h : 0.5 * h;
      slope = velocity(p + reach * slope, 3u * step + (k + 1u) / 2u);
      sum += (k == 0u || k == 3u ? 1.0 : 2.0) * slope;
    }
    p += h / 6.0 * sum;
  }
  return p;
}

// Between the points of a face's grid: `place` in its steps. Beyond the face, its outermost cells go on.
vec2 in_grid(uint first, int cells, vec2 place) {
  int j = clamp(int(floor(place.y)), 0, cells - 1);
  int i = clamp(int(floor(place.x)), 0, cells - 1 - j);
  vec2 f = place - vec2(i, j);
  uint row = first + uint(j * (2 * cells + 3 - j) / 2 + i), next = row + uint(cells + 1 - j);
  vec2 along = point_at(row + 1u), across = point_at(next);
  if (f.x + f.y > 1.0 && i + j < cells - 1) {
    vec2 corner = point_at(next + 1u);
    return corner + (1.0 - f.x) * (across - corner) + (1.0 - f.y) * (along - corner);
  }
  vec2 corner = point_at(row);
  return corner + f.x * (along - corner) + f.y * (across - corner);
}

// The mean of bilinear probes over the footprint. The place is `face.pixel + rest`; transparent outside the image.
vec4 sample_decal(FaceMap face, vec2 rest) {
  uvec4 stored = levels[face.level];
  float scale = 1.0 / float(1u << face.level);
  // At the finest level the whole pixels stay apart, so that no bit of the rest is lost to them.
  ivec2 whole = face.level == 0u ? face.pixel : ivec2(0);
  vec2 middle = face.level == 0u ? rest - 0.5 : (vec2(face.pixel) + rest) * scale - 0.5;
  vec4 sum = vec4(0.0);
  for (uint row = 0u; row < face.probes.y; ++row) {
    vec2 start = middle + ((float(row) + 0.5) / float(face.probes.y) - 0.5) * scale * face.along_y;
    for (uint column = 0u; column < face.probes.x; ++column) {
      vec2 place = start + ((float(column) + 0.5) / float(face.probes.x) - 0.5) * scale * face.along_x;
      vec2 base = floor(place);
      vec2 fraction = place - base;
      ivec2 corner = ivec2(base) + whole;
      for (int k = 0; k < 4; ++k) {
        ivec2 q = corner + ivec2(k & 1, k >> 1);
        if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, ivec2(stored.yz)))) continue;
        uint at = stored.x + uint(q.y) * stored.y + uint(q.x) - constants.piece_first;
        if (at >= constants.piece_size) continue;
        vec2 w = mix(1.0 - fraction, fraction, equal(ivec2(k & 1, k >> 1), ivec2(1)));
        uvec2 packed = decal[at];
        sum += w.x * w.y * vec4(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y));
      }
    }
  }
  return sum / float(face.probes.x * face.probes.y);
}

vec3 to_linear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045))); }
vec3 to_srgb(vec3 c) {
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

// The direction of the image's x in the texture's tangent frame, at `d` texels from the face's.
vec2 directions(FaceMap face, vec2 d) {
  uint first = face.first_point - 3u;
  vec2 along = point_at(first) + point_at(first + 1u) * d.x + point_at(first + 2u) * d.y;
  float squared = dot(along, along);
  return squared > 0.0 ? along * inversesqrt(squared) : vec2(1.0, 0.0);
}

void main() {
  uint block = block_at(constants.first + gl_WorkGroupID.x);
  ivec2 texel = ivec2(gl_LocalInvocationID.xy + block_size * uvec2(block & 0xffffu, block >> 16));
  ivec2 work = texel - constants.work_origin;
  if (any(lessThan(work, ivec2(0))) || any(greaterThanEqual(work, constants.work_size))) return;

  bool last_piece = (constants.piece_flags & piece_goes_on) == 0u;
  ivec2 seed = texel;
  uint owner = region[texel.y * constants.region_size.x + texel.x];
  if (owner == 0u) {
    uint nearest = uint(constants.region_size.x * constants.region_size.y);  // In `region`.
    int best = constants.gutter * constants.gutter + 1;
    for (int i = 0; i <= 2 * constants.gutter; ++i) {
      int dy = (i & 1) == 0 ? i / 2 : -(i + 1) / 2;
      int y = texel.y + dy;
      if (dy * dy >= best) break;
      if (y < 0 || y >= constants.region_size.y) continue;
      uint dx = region[nearest + y * constants.region_size.x + texel.x];
      if (dx == no_texel) continue;
      int squared = int(dx) * int(dx) + dy * dy;
      if (squared < best) {
        best = squared;
        seed = ivec2(texel.x + int(dx), y);
      }
    }
    uint key = region[seed.y * constants.region_size.x + seed.x] & key_mask;
    if (key == 0u) return;
    if (last_piece) atomicAdd(gutter, 1u);
    owner = key;
  } else {
    if ((owner & key_mask) == 0u) return;
    if (last_piece) atomicAdd(covered, 1u);
    if (last_piece && (owner & foreign_bit) != 0u) atomicAdd(shared_texels, 1u);
  }

  FaceMap face = face_at((owner & key_mask) - 1u);
  vec2 d = vec2(((face.flags & face_clamped) != 0u ? seed : texel) - face.texel);
  vec2 place = face.value + face.dx * d.x + face.dy * d.y;
  if (has_warp && (face.flags & face_warped) != 0u) {
    if (groups > 1u) {
      for (uint g = 0u; g < groups; g += 2u) {
        vec2 influence = in_grid(face.first_point + 3u + g / 2u * 3u, 1, place);
        shares[g] = influence_ramp(influence.x);
        if (g + 1u < groups) shares[g + 1u] = influence_ramp(influence.y);
      }
      place = in_grid(face.first_point, 1, place);
    }
    place = constants.half_size + constants.pixels_per_unit * warp(place);
  }
  uint cells = (face.flags & ~face_reversed) / face_cells;
  if (cells > 0u) place = in_grid(face.first_point, int(cells), place);
  int index = work.y * constants.work_size.x + work.x;
  if (constants.keep_samples != 0u && seed == texel)
    work_words[constants.work_samples + index] = floatBitsToUint(vec2(face.pixel) + place);

  vec4 source = constants.opacity * sample_decal(face, place);
  uint sum = constants.work_sums + 2u * uint(index);
  if ((constants.piece_flags & piece_follows) != 0u)
    source += uintBitsToFloat(uvec4(work_words[sum], work_words[sum + 1u]));
  if (!last_piece) {
    work_words[sum] = floatBitsToUint(source.xy);
    work_words[sum + 1u] = floatBitsToUint(source.zw);
    return;
  }
  if (source.a <= 0.0) return;
  uvec2 stored = work_words[index];
  vec4 below = vec4(unpackUnorm2x16(stored.x), unpackUnorm2x16(stored.y));
  vec4 result;
  if (constants.encoding == encoding_normal) {
    vec2 along = directions(face, d);
    vec2 across = (face.flags & face_reversed) != 0u ? vec2(along.y, -along.x) : vec2(-along.y, along.x);
    result = composite_normal(constants.blend, source, below, along, across);
  } else if (constants.encoding == encoding_data) {
    result = composite(constants.blend, source, below, true);
  } else {
    result = composite(constants.blend, source, vec4(to_linear(below.rgb), below.a), constants.opaque != 0u);
    result.rgb = to_srgb(clamp(result.rgb, 0.0, 1.0));
  }
  result = clamp(result, 0.0, 1.0);
  uvec4 value = uvec4(result * constants.max_value + 0.5) * uint(65535.0 / constants.max_value + 0.5);
  uvec4 kept = uvec4(stored.x & 0xffffu, stored.x >> 16, stored.y & 0xffffu, stored.y >> 16);
  value = mix(kept, value, notEqual(constants.channels & uvec4(1u, 2u, 4u, 8u), uvec4(0u)));
  work_words[index] = uvec2(value.x | value.y << 16, value.z | value.w << 16);
}
