#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/image/image.h"
#include "applique/image/image_frame.h"

namespace applique {

class Region;

/// The decal's image ready to be sampled: linear light (or data as they are), premultiplied alpha, cut by the
/// region's contour (its coverage of each pixel, anti-aliased, multiplies the alpha), with a mip pyramid of
/// box-filtered levels. Outside level 0 the image is transparent: a texel of level k is the mean of the 2^k x
/// 2^k pixels at (x, y)
/// * 2^k, and each level has half the size of the one below, rounded up.
struct DecalImage {
  struct Level {
    std::uint32_t offset;  ///< First texel in `texels`.
    std::uint32_t width;
    std::uint32_t height;
  };
  ImageFrame frame;
  std::vector<Level> levels;                 ///< Level 0 is the image itself; the last is 1 x 1.
  std::vector<std::array<float, 4>> texels;  ///< All levels one after another, row by row from the top.
};

/// Cuts `image` by `region` and builds the pyramid. `linear`: the image's values are data, not sRGB colours.
DecalImage make_decal_image(const Image& image, const Region& region, bool linear = false);

/// IEC 61966-2-1, values in [0, 1].
double srgb_to_linear(double encoded);
double linear_to_srgb(double linear);

}  // namespace applique
