#include "support/hills_decal.h"

#include "support/shapes.h"

namespace applique {

DecalInput hills_decal(const SurfaceMesh& hills) {
  constexpr int side = 512;
  constexpr double half_size = 0.92;  // of the image on the surface, which is two units wide
  const auto region = Region::from_contour({{0, 0}, {side, 0}, {side, side}, {0, side}}, {side, side});
  DecalInput input{"hills", *region, {}, {}};
  for (const auto& [x, y] : {std::pair(130, 150), std::pair(380, 150), std::pair(256, 270),
                             std::pair(180, 400), std::pair(340, 390)}) {
    const double s = half_size * (2.0 * x / side - 1), t = half_size * (1 - 2.0 * y / side);
    input.features.push_back({{double(x), double(y)}, shapes::nearest(hills, shapes::hills_at(s, t))});
  }
  return input;
}

}  // namespace applique
