#pragma once

#include <cstddef>

#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

namespace applique {

/// How a baked texture compares with many samples a texel.
struct BakeQuality {
  std::size_t texels = 0;  ///< That were compared.
  double psnr = 0;         ///< Of R, G and B, dB over 255.
  double largest = 0;      ///< Difference, of 255.
};

/// Compares every `stride`-th texel that the transfer covers with the mean of 8 x 8 samples over its square,
/// each through the exact map and from the full image (linear between pixels, linear light), composited over
/// `before`. For blending normal, textures without wrapping, and transfers of one sheet.
BakeQuality compare_with_samples(const Transfer& transfer, const Image& before, const Image& baked,
                                 const TransferResult& covered, std::size_t stride);

}  // namespace applique
