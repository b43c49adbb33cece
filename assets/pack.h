#pragma once

#include <vector>

#include "flatten.h"

namespace applique::assets {

/// Turns each chart into its smallest box and places all at the largest common scale that fits a square of
/// `size` texels, `gutter` texels apart and half of that from the sides: largest chart first, each at the
/// lowest free place of the four quarter turns, tested on a bitmap. Leaves `uvs` in texels.
void pack(std::vector<FlatChart>& charts, int size, int gutter);

}  // namespace applique::assets
