#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "applique/transfer/transfer.h"

#include "transfer_types.h"

namespace applique {

/// A rectangle of texels.
struct TexelRect {
  int x = 0, y = 0, width = 0, height = 0;
};

/// A face as a region sees it: moved by whole periods of the texture, mirrored where the wrap mode says so.
struct Placement {
  std::uint32_t face;            ///< Index in Transfer::faces.
  std::array<Texel, 3> corners;  ///< Region texels.
};

/// What is to be drawn of one sheet in one tile of a texture, the same for the GPU and for the CPU. The
/// *work* are the tile's texels that may change; the *region* is the work with a margin of the gutter's
/// width, in which owners are needed. Where an axis repeats, the region may reach over the border: it lies in
/// the texture's unwrapped plane.
struct TilePlan {
  TexelRect work;                               ///< In the texture. Empty: nothing to do.
  TexelRect region;                             ///< In the unwrapped plane.
  std::vector<Placement> placements;            ///< Key k is placement k - 1.
  std::vector<shader::RasterJob> jobs;          ///< Of the sheet's faces.
  std::vector<shader::RasterJob> foreign_jobs;  ///< Of the other sheets' faces and of foreign triangles.
  std::vector<std::uint32_t> blocks;  ///< Blocks that may change: x | y << 16, in blocks of the region.
  std::vector<std::uint32_t> nearest_blocks;  ///< Blocks whose row-wise nearest texels those need.
};

/// The ranks that faces of the transfer have, from below to above: what is composited one after the other.
std::vector<std::uint32_t> sheets_of(const Transfer& transfer);

/// A rectangle of the texture's unwrapped plane.
struct TexelBounds {
  std::array<double, 2> lower, upper;
};
/// By face: the part of it whose texels, or those that extend it in the gutter, may show some of the image. A
/// small decal may lie in a large triangle. None: nothing of it does.
std::vector<std::optional<TexelBounds>> shown_parts(const Transfer& transfer);

/// Plans the part of a sheet that lies in `tile`, a rectangle of the texture (at most 65536 texels a side).
/// The transfer's other sheets keep the gutter out, as foreign triangles do, but are not UV overlap.
///
/// Coverage is decided with corners rounded to 1/256 texel and exact integer edge functions; of two triangles
/// on either side of an edge through a texel's centre, one has it.
/// `shown` is shown_parts() of the transfer.
TilePlan plan_tile(const Transfer& transfer, std::span<const std::optional<TexelBounds>> shown,
                   int texture_width, int texture_height, const TexelRect& tile, std::uint32_t sheet = 0);

/// Sheets over each other are composited at 16 bits, whatever the texture has: so 8 bits are rounded to once,
/// when all are done.
int working_bits(const Image& texture, std::size_t sheets);
void round_to_8_bits(Image& texture);

/// The affine map of a placement, from region texels' centres to the plane or to pixels.
struct AffineMap {
  std::array<double, 2> value;   ///< At the centre of texel `origin`.
  std::array<double, 2> dx, dy;  ///< By texel.
  std::array<int, 2> origin;
  [[nodiscard]] std::array<double, 2> at(int x, int y) const {
    return {value[0] + dx[0] * (x - origin[0]) + dy[0] * (y - origin[1]),
            value[1] + dx[1] * (x - origin[0]) + dy[1] * (y - origin[1])};
  }
};

/// How a face's texels sample the image: a grid of bilinear probes over the parallelogram that a texel's
/// square is there, at one level of the pyramid. The shorter side has up to eight probes; the level is the
/// finest that these and four times as many along the longer side do for.
struct Footprint {
  std::array<double, 2> along_x = {0, 0}, along_y = {0, 0};  ///< The parallelogram's sides, pixels.
  int level = 0;
  std::array<int, 2> probes = {1, 1};  ///< Along each side.
};

/// All that both twins derive from a placement.
struct PlacedFace {
  /// To the plane where the face needs the warp, or, where it is refined, to steps of its grid; else to
  /// pixels. A warp with groups needs more than a plane point: there, to the place in a grid of one cell.
  AffineMap map;
  Footprint footprint;
  AffineMap along;  ///< To TransferFace::along; for normals.
  bool warped = false;
  bool clamped = false;  ///< Thinner than a texel: its gutter repeats its nearest texel, it is not extended.
};
/// `cells`: as RefinedFace::cells; 0 for a face that is not refined.
PlacedFace place_face(const Transfer& transfer, const Placement& placement, int cells = 0);

}  // namespace applique
