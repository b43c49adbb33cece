#pragma once

#include <vector>

#include "applique/base/types.h"

namespace applique {

/// How much of each pixel the simple polygon covers, 0 to 1: its exact area. For rows `first_row` to
/// `last_row` - 1 of an image `width` pixels wide, row by row. The polygon may have either orientation and
/// reach beyond the image.
std::vector<float> polygon_coverage(const std::vector<Pixel>& polygon, int width, int first_row,
                                    int last_row);

}  // namespace applique
