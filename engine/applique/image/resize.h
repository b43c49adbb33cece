#pragma once

#include "applique/image/image.h"

namespace applique {

/// The image at another size, filtered (OpenImageIO's choice: Lanczos down, Blackman-Harris up); colours do
/// not bleed out of transparent pixels. 16 bits.
Image resize_image(const Image& image, int width, int height);

}  // namespace applique
