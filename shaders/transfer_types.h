// What the transfer's shaders and the C++ side share. Included by both: the layouts agree because they are one.
// All rectangles are in texels of a tile's region: the part of the texture's plane that a tile sees.
#ifndef APPLIQUE_TRANSFER_TYPES_H
#define APPLIQUE_TRANSFER_TYPES_H

#ifdef __cplusplus
#include <array>
#include <cstddef>
#include <cstdint>
namespace applique::shader {
using uint = std::uint32_t;
using ivec2 = std::array<std::int32_t, 2>;
using vec2 = std::array<float, 2>;
using uvec2 = std::array<std::uint32_t, 2>;
using uvec4 = std::array<std::uint32_t, 4>;
using vec4 = std::array<float, 4>;
#define APPLIQUE_CONST constexpr
#else
#define APPLIQUE_CONST const
#endif

APPLIQUE_CONST uint block_size = 8u;            // Texels along a block's edge; the workgroup of all passes.
APPLIQUE_CONST uint foreign_bit = 0x80000000u;  // Owner: a foreign triangle covers the texel.
APPLIQUE_CONST uint sheet_bit = 0x40000000u;    // Owner: another sheet of the decal covers the texel.
APPLIQUE_CONST uint key_mask = 0x3fffffffu;     // Owner: 1 + the placement, 0 for none.
APPLIQUE_CONST uint copy_key = 0xc0000000u;     // A job's: foreign, but only to texels that faces own.
APPLIQUE_CONST uint max_levels = 24u;
APPLIQUE_CONST uint warp_table_capacity = 992u;  // vec4s; with the levels just under the 16 KiB of every device.

// `value` is a plane point that the warp carries to the image or, where features have groups, a place in a grid of one
// cell, with the plane points of its corners and then, for every two groups, their influence at the corners.
APPLIQUE_CONST uint face_warped = 1u;
APPLIQUE_CONST uint face_clamped = 2u;  // Too thin to extend: its gutter repeats its nearest texel.
APPLIQUE_CONST uint face_cells = 4u;    // Times the cells along a side of a refined face: `value` is a place in its grid.
APPLIQUE_CONST uint face_reversed = 0x80000000u;  // The texture's tangent frame is left-handed against the image's.

// Encoding.
APPLIQUE_CONST uint encoding_colour = 0u;
APPLIQUE_CONST uint encoding_data = 1u;
APPLIQUE_CONST uint encoding_normal = 2u;

APPLIQUE_CONST uint piece_follows = 1u;  // Another piece precedes this one.
APPLIQUE_CONST uint piece_goes_on = 2u;  // Another piece comes after it: nothing is blended yet.

APPLIQUE_CONST uint no_texel = 0x7fffffffu;  // Nearest pass: no owned texel in reach along the row.

// One triangle over one block. A texel (x, y) of the block is inside where every a * x + b * y + c >= 0.
struct RasterJob {
  int a[3];
  int b[3];
  int c[3];
  uint key;
  uint x;  // Texel of the block's corner.
  uint y;
};

// Where a face takes the texels: value + dx * (x - texel.x) + dy * (y - texel.y), in pixels relative to `pixel` or,
// where warped, in the plane, or, where it has a grid, in steps of that.
struct FaceMap {
  ivec2 texel;
  ivec2 pixel;
  vec2 value;
  vec2 dx;
  vec2 dy;
  vec2 along_x;  // The sides of the footprint, pixels.
  vec2 along_y;
  uvec2 probes;  // Along each.
  uint level;
  uint flags;
  uint first_point;  // Of the grid, where there is one. For normals, before it: a direction and its change by texel.
  uint padding;
};

struct TransferConstants {
  ivec2 region_size;
  ivec2 work_origin;  // The texels that may change.
  ivec2 work_size;
  int gutter;
  uint first;  // Job or block of the first workgroup.
  float opacity;
  uint blend;       // BlendMode.
  uint opaque;      // Whether the texture's alpha does not show.
  uint encoding;
  uint channels;    // Bit by channel: which are written.
  float max_value;  // 255 or 65535.
  uint keep_samples;
  uint steps;
  uint features;
  uint pairs;
  vec2 half_size;  // Of the image, pixels.
  vec2 pixels_per_unit;  // To the right and downwards, of the plane's x and y.
  uint piece_first;  // The decal's texels that are bound: what they give is added to what earlier pieces gave.
  uint piece_size;
  uint piece_flags;
  uint plan_faces;  // Where they begin in the plan, in uvec4s.
  uint plan_points;
  uint plan_warp;
  uint work_samples;  // Where they begin in the work, in uvec2s.
  uint work_sums;
};

#ifdef __cplusplus
static_assert(sizeof(RasterJob) == 48 && offsetof(RasterJob, key) == 36);
static_assert(sizeof(FaceMap) == 80 && offsetof(FaceMap, along_x) == 40 && offsetof(FaceMap, probes) == 56);
static_assert(sizeof(TransferConstants) == 120 && offsetof(TransferConstants, half_size) == 72);
}  // namespace applique::shader
#endif
#undef APPLIQUE_CONST
#endif
