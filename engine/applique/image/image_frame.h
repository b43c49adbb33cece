#pragma once

#include <algorithm>

#include "applique/base/types.h"

namespace applique {

/// The change of coordinates between an image's pixels (y down) and the decal's plane (y up, centred, the
/// image's longer side from -1 to 1). Everything that is solved lives in the plane; everything that a person
/// reads or writes is in pixels. Since y turns over, a map that keeps the plane's orientation shows the image
/// unmirrored on the outside of the surface.
struct ImageFrame {
  double width = 1;   ///< Pixels, > 0.
  double height = 1;  ///< Pixels, > 0.

  [[nodiscard]] double pixels_per_unit() const { return 0.5 * std::max(width, height); }
  [[nodiscard]] Vec2 to_plane(Pixel p) const {
    return {(p.x - 0.5 * width) / pixels_per_unit(), (0.5 * height - p.y) / pixels_per_unit()};
  }
  [[nodiscard]] Pixel to_pixel(Vec2 z) const {
    return {0.5 * width + z.real() * pixels_per_unit(), 0.5 * height - z.imag() * pixels_per_unit()};
  }
};

}  // namespace applique
