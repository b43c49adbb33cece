#include "decal_layers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "applique/image/coverage.h"
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

bool is_transparent(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 0) return false;
  return true;
}

/// Whether a stored vector has a direction, and one out of the surface but for what rounding and compression
/// leave.
bool is_surface_normal(const std::uint16_t* stored) {
  constexpr double shortest = 0.1, lowest = -0.05;
  const auto component = [&](int c) { return 2 * stored[c] / 65535.0 - 1; };
  const double x = component(0), y = component(1), z = component(2);
  return x * x + y * y + z * z >= shortest * shortest && z >= lowest;
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
      APPLIQUE_TRY(Image image, values(index));
      APPLIQUE_TRY(const auto shown, alpha());
      for (std::size_t i = 0; i < shown.size(); ++i)
        image.rgba[4 * i + 3] = product(image.rgba[4 * i + 3], shown[i]);
      images_[index] = make_decal_image(image, decal_->region, linear);
    }
  }
  return &*images_[index];
}

Result<Image> DecalLayers::values(std::size_t index) {
  const DecalLayer& layer = decal_->job.layers[index];
  APPLIQUE_TRY(Image image, source_of(layer));
  if (layer.scalar)
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      image.rgba[i + 1] = image.rgba[i + 2] = image.rgba[i];
  if (layer.slot == MaterialSlot::normal) APPLIQUE_CHECK(mend_normals(layer, image));
  if (is_transparent(image)) transparent_.insert(index);
  return image;
}

Result<std::span<const std::uint16_t>> DecalLayers::alpha() {
  if (alpha_.empty()) APPLIQUE_CHECK(load_alpha());
  return alpha_;
}

Result<void> DecalLayers::load_alpha() {
  const Image& own = decal_->image;
  alpha_.resize(static_cast<std::size_t>(own.width) * own.height);
  if (decal_->job.mask.empty()) {
    for (std::size_t i = 0; i < alpha_.size(); ++i) alpha_[i] = own.rgba[4 * i + 3];
    return {};
  }
  APPLIQUE_TRY(const Image mask, read_scaled(decal_->job.mask, Floats::data, mask_label_of(decal_->job)));
  for (std::size_t i = 0; i < alpha_.size(); ++i) alpha_[i] = product(mask.rgba[4 * i], mask.rgba[4 * i + 3]);
  return {};
}

Result<Image> DecalLayers::read_scaled(const std::filesystem::path& path, Floats floats,
                                       const std::string& label) const {
  auto image = read_image(path, floats);
  if (!image) return fail(image.error().code, fmt::format("{}: {}", label, image.error().message));
  if (image->width == decal_->image.width && image->height == decal_->image.height) return image;
  Image scaled = resize_image(*image, decal_->image.width, decal_->image.height);
  scaled.bits = image->bits;
  return scaled;
}

Result<Image> DecalLayers::source_of(const DecalLayer& layer) const {
  const Image& own = decal_->image;
  if (layer.value) return constant_image(own.width, own.height, *layer.value);
  if (!layer.image.empty())
    return read_scaled(layer.image,
                       encoding_of(layer.slot) == Encoding::colour ? Floats::light : Floats::data,
                       label_of(decal_->job, layer));
  Image image = own;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 65535;
  return image;
}

Result<void> DecalLayers::mend_normals(const DecalLayer& layer, Image& image) {
  APPLIQUE_TRY(const auto decal_alpha, alpha());
  std::size_t shown = 0, faulty = 0;
  for (std::size_t i = 0; i < decal_alpha.size(); ++i) {
    std::uint16_t* pixel = &image.rgba[4 * i];
    const bool seen = decal_alpha[i] > 0 && pixel[3] > 0;
    shown += seen ? 1 : 0;
    if (is_surface_normal(pixel)) continue;
    faulty += seen ? 1 : 0;
    pixel[0] = pixel[1] = 128 * 257;
    pixel[2] = 65535;
  }
  if (faulty == 0) return {};
  const std::string file = layer.image.filename().string();
  if (faulty == shown)
    return fail(ErrorCode::image_invalid,
                fmt::format("decal '{}': '{}' is no normal map: no pixel of it holds a direction out of the "
                            "surface, as (128, 128, 255) does; name another file, or leave the layer out",
                            decal_->job.name, file));
  // Where an image was scaled, a few vectors cancel out.
  constexpr double worth_a_word = 1e-3;
  const double share = static_cast<double>(faulty) / static_cast<double>(shown);
  if (share > worth_a_word)
    faulty_normals_.push_back(
        {"normal_map_faulty",
         fmt::format("decal '{}': {:.2g} % of the pixels of '{}' hold no direction out of the "
                     "surface; they are taken as flat, (128, 128, 255)",
                     decal_->job.name, 100 * share, file)});
  return {};
}

Result<bool> DecalLayers::shows_in_region() {
  APPLIQUE_TRY(const auto shown, alpha());
  const auto width = static_cast<std::size_t>(decal_->image.width);
  for (int y = 0; y < decal_->image.height; ++y) {
    const auto row = shown.subspan(static_cast<std::size_t>(y) * width, width);
    if (std::all_of(row.begin(), row.end(), [](std::uint16_t value) { return value == 0; })) continue;
    const auto coverage = polygon_coverage(decal_->region.contour(), decal_->image.width, y, y + 1);
    for (std::size_t x = 0; x < width; ++x)
      if (row[x] != 0 && coverage[x] > 0) return true;
  }
  return false;
}

/// Why nothing of the decal is seen, whatever its layers; empty: some is.
Result<std::string> DecalLayers::why_invisible() {
  if (decal_->job.opacity == 0) return "its \"opacity\" is 0";
  // An overlay is seen by the alpha of its base colour, the first layer.
  if (decal_->job.output == DecalOutput::overlay)
    if (const std::string why = why_invisible(0); !why.empty()) return "its base colour's " + why;
  APPLIQUE_TRY(const bool shows, shows_in_region());
  if (shows) return "";
  if (decal_->job.mask.empty())
    return fmt::format(
        "its image '{}' is transparent all over its region; move the region, or give a \"mask\"",
        decal_->job.image.filename().string());
  return fmt::format(
      "its mask '{}' is black or transparent all over its region; it shows where that is white",
      decal_->job.mask.filename().string());
}

/// What of a layer makes that nothing of it is seen, where its decal is; empty: some is.
std::string DecalLayers::why_invisible(std::size_t index) const {
  const DecalLayer& layer = decal_->job.layers[index];
  if (layer.opacity == 0) return "\"opacity\" is 0";
  if (!transparent_.contains(index)) return "";
  return fmt::format("image '{}' is transparent all over", layer.image.filename().string());
}

Result<std::vector<Warning>> DecalLayers::warnings() {
  std::vector<Warning> warnings = faulty_normals_;
  const auto add = [&](const std::string& label, const std::string& why) {
    warnings.push_back({"invisible", fmt::format("{}: nothing of it is seen, because {}", label, why)});
  };
  APPLIQUE_TRY(const std::string why, why_invisible());
  if (!why.empty()) {
    add(fmt::format("decal '{}'", decal_->job.name), why);
    return warnings;
  }
  for (std::size_t i = 0; i < decal_->job.layers.size(); ++i)
    if (const std::string of_layer = why_invisible(i); !of_layer.empty())
      add(label_of(decal_->job, decal_->job.layers[i]), "its " + of_layer);
  return warnings;
}

Result<void> check_layers(SolvedDecal& decal) {
  DecalLayers layers(decal);
  for (std::size_t i = 0; i < decal.job.layers.size(); ++i)
    if (const auto values = layers.values(i); !values) return tl::unexpected<Error>(values.error());
  APPLIQUE_TRY(const auto warnings, layers.warnings());
  decal.warnings.insert(decal.warnings.end(), warnings.begin(), warnings.end());
  return {};
}

}  // namespace applique
