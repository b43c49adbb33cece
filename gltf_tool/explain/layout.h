#pragma once

#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/image/draw.h"

#include "model_picture.h"

namespace applique {

/// A rectangle of a picture, pixels.
struct Box {
  Vec2 low;
  Vec2 size;

  [[nodiscard]] Vec2 middle() const { return low + 0.5 * size; }
  [[nodiscard]] draw::Outline outline() const;
};

/// Equal boxes, row by row with even margins, in as many columns as show contents of the given shape (width
/// over height) largest.
std::vector<Box> lay_out(PictureSize size, std::size_t count, double aspect);

/// Width over height of the points' bounding box.
double aspect_of(std::span<const Vec2> points);

/// Where points of a plane (y up) are in a picture (y down).
struct PlaneView {
  Vec2 centre;       ///< Plane.
  Vec2 middle;       ///< Picture: where the centre is.
  double scale = 1;  ///< Pixels per plane unit.

  [[nodiscard]] Vec2 operator()(Vec2 z) const { return middle + scale * std::conj(z - centre); }
  [[nodiscard]] Vec2 to_plane(Vec2 p) const { return centre + std::conj(p - middle) / scale; }
  [[nodiscard]] draw::Outline operator()(std::span<const Vec2> line) const;
};

/// Shows the points' bounding box as large as the box holds it, with a margin (a share of the box) around.
PlaneView fit(std::span<const Vec2> points, const Box& box, double margin = 0.04);

}  // namespace applique
