#pragma once

#include <vector>

#include "applique/base/types.h"

namespace applique {

/// How much of each pixel of a `width` x `height` image the simple polygon covers, 0 to 1, row by row from
/// the top: its exact area. The polygon may have either orientation and reach beyond the image.
std::vector<float> polygon_coverage(const std::vector<Pixel>& polygon, int width, int height);

}  // namespace applique
