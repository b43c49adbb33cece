#pragma once

#include <algorithm>

#include "applique/base/types.h"

namespace applique {

/// The change of coordinates between an image's pixels (y down) and the decal's plane (y up, centred, the
/// image's longer side from -1 to 1). Everything that is solved lives in the plane; everything that a person
/// reads or writes is in pixels. Since y turns over, a map that keeps the plane's orientation shows the image
/// unmirrored on the outside of the surface; a mirrored frame swaps left and right, and only the frame knows.
struct ImageFrame {
  double width = 1;       ///< Pixels, > 0.
  double height = 1;      ///< Pixels, > 0.
  bool mirrored = false;  ///< The plane's x runs to the image's left.

  [[nodiscard]] double pixels_per_unit() const { return 0.5 * std::max(width, height); }
  /// Pixels to the right per plane unit of x.
  [[nodiscard]] double pixels_along_x() const { return mirrored ? -pixels_per_unit() : pixels_per_unit(); }
  [[nodiscard]] Vec2 to_plane(Pixel p) const {
    return {(p.x - 0.5 * width) / pixels_along_x(), (0.5 * height - p.y) / pixels_per_unit()};
  }
  [[nodiscard]] Pixel to_pixel(Vec2 z) const {
    return {0.5 * width + z.real() * pixels_along_x(), 0.5 * height - z.imag() * pixels_per_unit()};
  }
};

}  // namespace applique
