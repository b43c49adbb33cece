#pragma once

#include <array>
#include <span>

#include "applique/transfer/transfer.h"

namespace applique {

/// An affine map between two planes of texels: (xx x + xy y + x0, yx x + yy y + y0).
struct TexelMap {
  double xx = 1, xy = 0, yx = 0, yy = 1;
  double x0 = 0, y0 = 0;

  [[nodiscard]] Texel operator()(const Texel& p) const {
    return {xx * p[0] + xy * p[1] + x0, yx * p[0] + yy * p[1] + y0};
  }
};

/// The map that carries one triangle to the other; the first has an area.
TexelMap map_between(const std::array<Texel, 3>& from, const std::array<Texel, 3>& to);

/// What a circle of radius 1 becomes: the half axes of its ellipse, the longer first.
std::array<double, 2> half_axes(const TexelMap& map);

/// The longer half axis of the maps between the triangles, as nineteen in twenty of the first ones' area have
/// it at most; 0 if they have no area.
double usual_stretch(std::span<const std::array<Texel, 3>> from, std::span<const std::array<Texel, 3>> to);

}  // namespace applique
