#include "decal_layers.h"

#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "applique/image/resize.h"

namespace applique {
namespace {

std::uint16_t product(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint16_t>((a * b + 32767) / 65535);
}

Image constant_image(int width, int height, const std::array<double, 3>& value) {
  std::array<std::uint16_t, 4> stored = {0, 0, 0, 65535};
  for (std::size_t c = 0; c < 3; ++c) stored[c] = static_cast<std::uint16_t>(std::lround(65535 * value[c]));
  return make_image(width, height, stored);
}

}  // namespace

Encoding encoding_of(MaterialSlot slot) {
  switch (slot) {
    case MaterialSlot::base_color:
    case MaterialSlot::emissive:
      return Encoding::colour;
    case MaterialSlot::normal:
      return Encoding::normal;
    default:
      return Encoding::data;
  }
}

Result<const DecalImage*> DecalLayers::image(std::size_t index) {
  if (!images_[index]) {
    const DecalLayer& layer = decal_->job.layers[index];
    const bool linear = encoding_of(layer.slot) != Encoding::colour;
    if (layer.image.empty() && !layer.value && decal_->job.mask.empty()) {
      images_[index] = make_decal_image(decal_->image, decal_->region, linear);
    } else {
      if (alpha_.empty()) APPLIQUE_CHECK(load_alpha());
      APPLIQUE_TRY(Image image, colours(layer));
      for (std::size_t i = 0; i < alpha_.size(); ++i) {
        std::uint16_t* pixel = &image.rgba[4 * i];
        if (layer.scalar) pixel[1] = pixel[2] = pixel[0];
        pixel[3] = product(pixel[3], alpha_[i]);
      }
      images_[index] = make_decal_image(image, decal_->region, linear);
    }
  }
  return &*images_[index];
}

Result<void> DecalLayers::load_alpha() {
  const Image& own = decal_->image;
  alpha_.resize(static_cast<std::size_t>(own.width) * own.height);
  if (decal_->job.mask.empty()) {
    for (std::size_t i = 0; i < alpha_.size(); ++i) alpha_[i] = own.rgba[4 * i + 3];
    return {};
  }
  APPLIQUE_TRY(const Image mask, read_scaled(decal_->job.mask));
  for (std::size_t i = 0; i < alpha_.size(); ++i) alpha_[i] = product(mask.rgba[4 * i], mask.rgba[4 * i + 3]);
  return {};
}

Result<Image> DecalLayers::read_scaled(const std::filesystem::path& path) const {
  auto image = read_image(path);
  if (!image)
    return fail(image.error().code, fmt::format("decal '{}': {}", decal_->job.name, image.error().message));
  if (image->width == decal_->image.width && image->height == decal_->image.height) return image;
  return resize_image(*image, decal_->image.width, decal_->image.height);
}

/// What the layer has for each pixel; its alpha is its own, that of the decal's image where it shows that
/// one.
Result<Image> DecalLayers::colours(const DecalLayer& layer) const {
  const Image& own = decal_->image;
  if (layer.value) return constant_image(own.width, own.height, *layer.value);
  if (!layer.image.empty()) return read_scaled(layer.image);
  Image image = own;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 65535;
  return image;
}

}  // namespace applique
