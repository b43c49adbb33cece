#include "material.h"

#include <cmath>
#include <optional>

namespace applique {
namespace {

using Json = Document::Json;

double number_or(const Json& object, const char* key, double fallback) {
  const auto* value = find(object, {key});
  return value != nullptr && value->is_number() ? value->get<double>() : fallback;
}

template <std::size_t N>
std::array<double, N> numbers_or(const Json* values, std::array<double, N> fallback) {
  if (values == nullptr || !values->is_array() || values->size() != N) return fallback;
  for (std::size_t i = 0; i < N; ++i)
    if ((*values)[i].is_number()) fallback[i] = (*values)[i].template get<double>();
  return fallback;
}

WrapMode read_wrap(const Json& sampler, const char* key) {
  switch (index_of(sampler, key).value_or(10497)) {
    case 33071:
      return WrapMode::clamp;
    case 33648:
      return WrapMode::mirror;
    default:
      return WrapMode::repeat;
  }
}

}  // namespace

std::array<double, 2> UvMapping::apply(const std::array<double, 2>& uv) const {
  const double c = std::cos(rotation);
  const double s = std::sin(rotation);
  const double u = scale[0] * uv[0];
  const double v = scale[1] * uv[1];
  return {offset[0] + c * u + s * v, offset[1] - s * u + c * v};
}

std::optional<std::size_t> image_of_texture(const Json& texture) {
  if (const auto* webp = find(texture, {"extensions", "EXT_texture_webp"}))
    if (const auto image = index_of(*webp, "source")) return image;
  if (const auto image = index_of(texture, "source")) return image;
  for (const char* extension : {"KHR_texture_basisu", "MSFT_texture_dds"})
    if (const auto* object = find(texture, {"extensions", extension}))
      if (const auto image = index_of(*object, "source")) return image;
  return std::nullopt;
}

UvMapping read_uv_mapping(const Json& material) {
  const auto* texture = find(material, {"pbrMetallicRoughness", "baseColorTexture"});
  return texture == nullptr ? UvMapping() : read_texture_mapping(*texture);
}

UvMapping read_texture_mapping(const Json& reference) {
  UvMapping mapping;
  mapping.set = index_of(reference, "texCoord").value_or(0);
  if (const auto* transform = find(reference, {"extensions", "KHR_texture_transform"})) {
    mapping.set = index_of(*transform, "texCoord").value_or(mapping.set);
    mapping.offset = numbers_or(find(*transform, {"offset"}), mapping.offset);
    mapping.scale = numbers_or(find(*transform, {"scale"}), mapping.scale);
    mapping.rotation = number_or(*transform, "rotation", 0);
  }
  return mapping;
}

ModelMaterial read_material(const Document& document, const Json& entry) {
  ModelMaterial material;
  if (const auto* name = find(entry, {"name"}); name != nullptr && name->is_string())
    material.name = name->get<std::string>();
  if (const auto* mode = find(entry, {"alphaMode"}); mode != nullptr && mode->is_string())
    material.alpha_mode = mode->get<std::string>();
  material.alpha_cutoff = number_or(entry, "alphaCutoff", 0.5);
  const auto* double_sided = find(entry, {"doubleSided"});
  material.double_sided = double_sided != nullptr && *double_sided == true;
  material.base_colour_factor =
      numbers_or(find(entry, {"pbrMetallicRoughness", "baseColorFactor"}), material.base_colour_factor);
  const auto* base = find(entry, {"pbrMetallicRoughness", "baseColorTexture"});
  if (base == nullptr) return material;
  material.texture = index_of(*base, "index");
  const auto& texture = document.json["textures"][*material.texture];
  material.image = image_of_texture(texture);
  const auto [wrap_u, wrap_v] = read_wrap_modes(document, texture);
  material.wrap_u = wrap_u;
  material.wrap_v = wrap_v;
  return material;
}

std::array<WrapMode, 2> read_wrap_modes(const Document& document, const Json& texture) {
  const auto sampler = index_of(texture, "sampler");
  if (!sampler) return {WrapMode::repeat, WrapMode::repeat};
  const auto& entry = document.json["samplers"][*sampler];
  return {read_wrap(entry, "wrapS"), read_wrap(entry, "wrapT")};
}

}  // namespace applique
