#pragma once

#include <array>
#include <vector>

#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

#include "uv_layout.h"

namespace applique {

/// What a texture's texels are, which says how they are averaged.
enum class TexelContent {
  colour,  ///< sRGB: averaged in linear light.
  data,    ///< As they are.
  normal,  ///< Directions in the tangent frame, in red and green: turned with the frame.
};

/// From the old tangent frame to the new one: x' = xx x + xy y, y' = yx x + yy y. Without length or shear.
struct FrameTurn {
  double xx = 1, xy = 0, yx = 0, yy = 1;
};

/// An old texture, and how it is to be shown in a layout.
struct Resampling {
  const Image* texture = nullptr;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  bool nearest = false;  ///< The sampler magnifies without interpolation.
  TexelContent content = TexelContent::colour;
  const UvLayout* layout = nullptr;
  std::array<int, 2> size = {0, 0};  ///< Texels of the new texture.
  int bits = 8;                      ///< A channel of the new texture, 8 or 16.
  /// Old texels of the texture that the layout started from, by texel of this one, where both are shown
  /// through the same texture coordinates; charts that are kept are then copied as a whole, unless something
  /// is to be turned. Zero: others.
  std::array<double, 2> reference = {0, 0};
  std::vector<std::array<Texel, 3>> old_corners;  ///< By triangle of the layout, in texels.
  std::vector<std::array<FrameTurn, 3>> turns;    ///< By triangle and corner; empty: none is turned.
};

/// The texture in its new layout, with the old one's channels. Each texel gets what the sampler
/// shows of the old texture at its centre (bilinear, wrapped), or the mean over its square where the old one
/// is finer; texels that are hit exactly are copied. The gutter continues the old texture as the
/// nearest triangle shows it; between the charts is the mean colour.
Image resample_texture(const Resampling& resampling);

/// The size at which a layout loses no detail of a texture that it did not start from.
std::array<int, 2> resampled_size(const Resampling& resampling);

/// Whether the texture would look in its new layout as it does now, to 2/255 where it is magnified: between
/// the new texels' centres, where what a sampler shows strays most from the old one, and along edges on
/// either side of which the old layout shows something, but now one thing.
bool keeps_look(const Resampling& resampling);

}  // namespace applique
