#include "applique/image/resize.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

namespace applique {

Image resize_image(const Image& image, int width, int height) {
  OIIO::ImageSpec spec(image.width, image.height, 4, OIIO::TypeDesc::UINT16);
  spec.alpha_channel = 3;
  const OIIO::ImageBuf straight(spec, const_cast<std::uint16_t*>(image.rgba.data()));  // NOLINT: only read
  OIIO::ImageSpec scaled_spec(width, height, 4, OIIO::TypeDesc::FLOAT);
  scaled_spec.alpha_channel = 3;
  OIIO::ImageBuf premultiplied = OIIO::ImageBufAlgo::premult(straight);
  OIIO::ImageBuf scaled(scaled_spec);
  OIIO::ImageBufAlgo::resize(scaled, premultiplied);
  OIIO::ImageBufAlgo::unpremult(scaled, scaled);
  Image result = make_image(width, height, {0, 0, 0, 0});
  result.channels = image.channels;
  result.bits = 16;
  scaled.get_pixels(scaled.roi(), OIIO::TypeDesc::UINT16, result.rgba.data());
  return result;
}

}  // namespace applique
