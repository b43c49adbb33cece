#include "overlay_layers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <span>

#include <fmt/format.h>

#include "applique/base/parallel.h"
#include "applique/image/coverage.h"
#include "applique/image/decal_image.h"

#include "compositing.h"
#include "decal_layers.h"
#include "instances.h"

namespace applique {
namespace {

using Values = std::array<double, 3>;  // As a texture stores them, 0 to 1.

/// What a slot is like under a decal.
struct Ground {
  Values values = {};
  bool known = true;  ///< It is one value all over; else `values` are the plain material's.
};

Values plain_values(MaterialSlot slot) {
  switch (slot) {
    case MaterialSlot::metallic_roughness:
      return {1, 1, 0};
    case MaterialSlot::normal:
      return {128.0 / 255, 128.0 / 255, 1};
    case MaterialSlot::emissive:
      return {0, 0, 0};
    default:
      return {1, 1, 1};
  }
}

Ground find_ground(const Model& model, const SolvedDecal& decal, MaterialSlot slot) {
  const auto none = Document::Json::object();
  std::set<Values> values;
  for (const auto& index : materials_under(decal, model)) {
    const auto& material = index ? model.document.json.at("materials").at(*index) : none;
    if (find_texture_info(material, slot) != nullptr) return {plain_values(slot), false};
    const auto factors = read_factors(material, slot);
    values.insert({factors[0], factors[1], factors[2]});
  }
  if (values.size() != 1) return {plain_values(slot), false};
  if (slot == MaterialSlot::normal)
    return {plain_values(slot), true};  // Flat, as a texture stores it exactly.
  Values ground = *values.begin();
  if (encoding_of(slot) == Encoding::colour)
    for (double& value : ground) value = linear_to_srgb(value);
  return {ground, true};
}

/// A layer's value over the ground's, by the transfer's own compositing.
Values lay_over(const DecalLayer& layer, BlendMode blend, const Values& ground, const Values& own,
                double alpha) {
  if (alpha <= 0) return ground;
  const Encoding encoding = encoding_of(layer.slot);
  const auto mode = static_cast<std::uint32_t>(blend);
  compositing::vec4 source, below;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const bool colour = encoding == Encoding::colour;
    source[c] = alpha * (colour ? srgb_to_linear(own[channel]) : own[channel]);
    below[c] = colour ? srgb_to_linear(ground[channel]) : ground[channel];
  }
  source[3] = alpha;
  below[3] = 1;
  const compositing::vec4 result = encoding == Encoding::normal
                                       ? compositing::composite_normal(mode, source, below, {1, 0}, {0, 1})
                                       : compositing::composite(mode, source, below, true);
  Values values = {};
  for (int c = 0; c < 3; ++c) {
    const double value = std::clamp<double>(result[c], 0, 1);
    values[static_cast<std::size_t>(c)] = encoding == Encoding::colour ? linear_to_srgb(value) : value;
  }
  return values;
}

std::uint16_t stored(double value) {
  return static_cast<std::uint16_t>(std::lround(65535 * std::clamp(value, 0.0, 1.0)));
}

void warn_of_blend(SolvedDecal& decal, const DecalLayer& layer, const char* why) {
  decal.warnings.push_back(
      {"blend_ignored", fmt::format("decal '{}': the blend mode \"{}\" of its {} is not used, because {}; it "
                                    "shows as by \"normal\"; bake the decal to have it",
                                    decal.job.name, name_of(layer.blend), layer.name, why)});
}

/// Whether a layer lets much through where the decal is seen: more than its edge.
bool is_transparent(const Image& values, std::span<const std::uint16_t> shown) {
  constexpr double much = 0.02;
  double seen = 0, through = 0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    seen += shown[i];
    through += shown[i] * (1 - values.rgba[4 * i + 3] / 65535.0);
  }
  return through > much * seen;
}

/// Composes an overlay's slots but for the base colour.
class Slots {
 public:
  Slots(const Model& model, SolvedDecal& decal, DecalLayers& layers)
      : model_(&model), decal_(&decal), layers_(&layers) {}

  Result<void> add(MaterialSlot slot, OverlayLayers& out) {
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < decal_->job.layers.size(); ++i)
      if (decal_->job.layers[i].slot == slot) own.push_back(i);
    if (own.empty()) return {};
    const Ground ground = find_ground(*model_, *decal_, slot);
    if (std::all_of(own.begin(), own.end(), [&](std::size_t i) { return layer(i).value.has_value(); })) {
      add_constant(slot, own, ground, out);
      return {};
    }
    return add_picture(slot, own, ground, out);
  }

 private:
  [[nodiscard]] const DecalLayer& layer(std::size_t index) const { return decal_->job.layers[index]; }

  /// The layer's blend mode, if it can be had.
  BlendMode blend_over(const Ground& ground, const DecalLayer& layer) {
    if (layer.blend == BlendMode::normal || ground.known) return layer.blend;
    warn_of_blend(*decal_, layer, "what the material under the overlay has there is not one value");
    return BlendMode::normal;
  }

  void warn_of_ground(const Ground& ground, const DecalLayer& layer, bool transparent) {
    if (ground.known || (layer.opacity == 1 && !transparent)) return;
    decal_->warnings.push_back(
        {"overlay_ground_unknown",
         fmt::format(
             "decal '{}': its {} lets through what the material under the overlay has there, which is "
             "not one value but a texture or several; a plain material takes its place; bake the "
             "decal, or make the layer opaque",
             decal_->job.name, layer.name)});
  }

  void add_constant(MaterialSlot slot, const std::vector<std::size_t>& own, const Ground& ground,
                    OverlayLayers& out) {
    Values result = plain_values(slot);
    for (const std::size_t i : own) {
      warn_of_ground(ground, layer(i), false);
      const Values values =
          lay_over(layer(i), blend_over(ground, layer(i)), ground.values, *layer(i).value, layer(i).opacity);
      for (std::size_t c = 0; c < 3; ++c)
        if (layer(i).channels[c]) result[c] = values[c];
    }
    if (slot == MaterialSlot::metallic_roughness) {
      out.roughness = result[1];
      out.metallic = result[2];
    } else if (slot == MaterialSlot::emissive) {
      for (std::size_t c = 0; c < 3; ++c) out.emissive[c] = srgb_to_linear(result[c]);
    } else {
      Image image = make_image(1, 1, {stored(result[0]), 65535, 65535, 65535});
      image.channels = 3;
      out.pictures.push_back({slot, std::move(image)});
    }
  }

  Result<void> add_picture(MaterialSlot slot, const std::vector<std::size_t>& own, const Ground& ground,
                           OverlayLayers& out) {
    const Values plain = plain_values(slot);
    Image picture = make_image(decal_->image.width, decal_->image.height,
                               {stored(plain[0]), stored(plain[1]), stored(plain[2]), 65535});
    picture.channels = 3;
    for (const std::size_t i : own) {
      APPLIQUE_TRY(const Image values, layers_->values(i));
      APPLIQUE_TRY(const auto shown, layers_->alpha());
      warn_of_ground(ground, layer(i), is_transparent(values, shown));
      draw(layer(i), blend_over(ground, layer(i)), ground, values, picture);
      picture.bits = std::max(picture.bits, values.bits);
    }
    if (slot == MaterialSlot::metallic_roughness) out.metallic = out.roughness = 1;
    if (slot == MaterialSlot::emissive) out.emissive = {1, 1, 1};
    out.pictures.push_back({slot, std::move(picture)});
    return {};
  }

  static void draw(const DecalLayer& layer, BlendMode blend, const Ground& ground, const Image& values,
                   Image& picture) {
    parallel_for(picture.height, [&](int y) {
      for (int x = 0; x < picture.width; ++x) {
        const std::uint16_t* own = values.pixel(x, y);
        std::uint16_t* texel = picture.pixel(x, y);
        const double alpha = layer.opacity * own[3] / 65535.0;
        if (alpha == 1 && blend == BlendMode::normal) {
          for (std::size_t c = 0; c < 3; ++c)
            if (layer.channels[c]) texel[c] = own[c];
          continue;
        }
        const Values over = lay_over(layer, blend, ground.values,
                                     {own[0] / 65535.0, own[1] / 65535.0, own[2] / 65535.0}, alpha);
        for (std::size_t c = 0; c < 3; ++c)
          if (layer.channels[c]) texel[c] = stored(over[c]);
      }
    });
  }

  const Model* model_;
  SolvedDecal* decal_;
  DecalLayers* layers_;
};

/// The base colour with the alpha of the overlay.
Result<Image> base_colour(SolvedDecal& decal, DecalLayers& layers) {
  const auto found =
      std::find_if(decal.job.layers.begin(), decal.job.layers.end(),
                   [](const DecalLayer& layer) { return layer.slot == MaterialSlot::base_color; });
  APPLIQUE_ASSERT(found != decal.job.layers.end());
  if (found->blend != BlendMode::normal)
    warn_of_blend(decal, *found, "glTF lays an overlay over the surface only");
  APPLIQUE_TRY(Image image, layers.values(static_cast<std::size_t>(found - decal.job.layers.begin())));
  APPLIQUE_TRY(const auto shown, layers.alpha());
  image.channels = 4;
  const double opacity = decal.job.opacity * found->opacity;
  parallel_for(image.height, [&](int y) {
    const auto coverage = polygon_coverage(decal.region.contour(), image.width, y, y + 1);
    for (int x = 0; x < image.width; ++x) {
      std::uint16_t* pixel = image.pixel(x, y);
      const auto i = static_cast<std::size_t>(x);
      const double cut = coverage[i] * shown[static_cast<std::size_t>(y) * image.width + i] / 65535.0;
      pixel[3] = stored(opacity * cut * pixel[3] / 65535.0);
    }
  });
  return image;
}

}  // namespace

Result<OverlayLayers> make_overlay_layers(const Model& model, SolvedDecal& decal) {
  DecalLayers layers(decal);
  OverlayLayers out;
  APPLIQUE_TRY(Image base, base_colour(decal, layers));
  out.pictures.push_back({MaterialSlot::base_color, std::move(base)});
  Slots slots(model, decal, layers);
  for (const MaterialSlot slot : all_slots)
    if (slot != MaterialSlot::base_color) APPLIQUE_CHECK(slots.add(slot, out));
  APPLIQUE_TRY(const auto warnings, layers.warnings());
  decal.warnings.insert(decal.warnings.end(), warnings.begin(), warnings.end());
  return out;
}

}  // namespace applique
