#pragma once

#include <array>
#include <vector>

#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

#include "texture_slots.h"
#include "uv_layout.h"

namespace applique {

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

/// How the texture that a material shows in some slots goes into a layout: `layout` of a request for a
/// texture of `started_from` texels that is shown through `base`; both stay as long as what is returned, as
/// does the image. No directions are turned yet.
Resampling plan_resampling(const Document& document, const TextureSlots& slots, const Image& image,
                           std::vector<std::array<Texel, 3>> old_corners, const UvLayout& layout,
                           const std::array<int, 2>& started_from, const UvMapping& base);

/// The texture in its new layout, with the old one's channels. Each texel gets what the sampler
/// shows of the old texture at its centre (bilinear, wrapped), or the mean over its square where the old one
/// is finer; texels that are hit exactly are copied. The gutter continues the old texture as the
/// nearest triangle shows it; between the charts is the mean colour.
Image resample_texture(const Resampling& resampling);

/// Whether the texture would look in its new layout as it does now, to 2/255 where it is magnified: between
/// the new texels' centres, where what a sampler shows strays most from the old one, and along edges on
/// either side of which the old layout shows something, but now one thing.
bool keeps_look(const Resampling& resampling);

}  // namespace applique
