#pragma once

#include <optional>
#include <span>
#include <vector>

#include "applique/transfer/raster.h"
#include "applique/transfer/transfer.h"

namespace applique {

/// A face that the warp bends, cut into cells * cells similar triangles that it hardly bends. Cuts along the
/// sides from corner 0 to corners 1 and 2 run in steps of 1 / cells.
struct RefinedFace {
  int cells = 0;  ///< 0: not cut.
  std::vector<Pixel>
      points;  ///< Image points: [index(i, j)] of corner0 + (i (corner1 - corner0) + j (…2 - …0)) / cells.

  [[nodiscard]] static int index(int cells, int i, int j) { return j * (2 * cells + 3 - j) / 2 + i; }
  /// Between the points, at (x, y) in steps of the grid. Beyond the face, its outermost triangles go on.
  [[nodiscard]] Pixel at(double x, double y) const;
};

/// The exact image point of a place in face `face`, u of the way from corner 0 to corner 1 and v to corner 2:
/// the warp, told the influence there.
Pixel warp_in_face(const Transfer& transfer, std::size_t face, double u, double v);

/// Cuts every face that is not linear so finely that interpolating between `points` stays within 0.02 pixel
/// of the warp, where the image is: the grid of half as many cells is within 0.04 pixel at the midpoints of
/// all its edges, and halving quarters the error of a smooth map. A face stays uncut where that would take
/// more points than it has texels in its part of `shown` (raster.h), or more than 1024 cells a side, or is
/// sure to: there, the warp at each texel is cheaper. One entry per face of the transfer.
std::vector<RefinedFace> refine_faces(const Transfer& transfer,
                                      std::span<const std::optional<TexelBounds>> shown);

}  // namespace applique
