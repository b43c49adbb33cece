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

const char* name_of(MaterialSlot slot) {
  constexpr std::array names = {"baseColor", "metallicRoughness", "normal", "occlusion", "emissive"};
  return names[static_cast<std::size_t>(slot)];
}

const Json* find_texture_info(const Json& material, MaterialSlot slot) {
  switch (slot) {
    case MaterialSlot::base_color:
      return find(material, {"pbrMetallicRoughness", "baseColorTexture"});
    case MaterialSlot::metallic_roughness:
      return find(material, {"pbrMetallicRoughness", "metallicRoughnessTexture"});
    case MaterialSlot::normal:
      return find(material, {"normalTexture"});
    case MaterialSlot::occlusion:
      return find(material, {"occlusionTexture"});
    case MaterialSlot::emissive:
      return find(material, {"emissiveTexture"});
  }
  return nullptr;
}

UvMapping read_uv_mapping(const Json& material, MaterialSlot slot) {
  const auto* texture = find_texture_info(material, slot);
  if (texture == nullptr) texture = find_texture_info(material, MaterialSlot::base_color);
  return texture == nullptr ? UvMapping() : read_texture_mapping(*texture);
}

std::array<double, 4> read_factors(const Json& material, MaterialSlot slot) {
  const auto number = [&](const char* key) {
    const auto* value = find(material, {"pbrMetallicRoughness", key});
    return value != nullptr ? value->get<double>() : 1.0;
  };
  switch (slot) {
    case MaterialSlot::base_color:
      return numbers_or(find(material, {"pbrMetallicRoughness", "baseColorFactor"}),
                        std::array{1.0, 1.0, 1.0, 1.0});
    case MaterialSlot::metallic_roughness:
      return {1, number("roughnessFactor"), number("metallicFactor"), 1};
    case MaterialSlot::normal:
      return {0.5, 0.5, 1, 1};
    case MaterialSlot::occlusion:
      return {1, 1, 1, 1};
    case MaterialSlot::emissive: {
      const auto factor = numbers_or(find(material, {"emissiveFactor"}), std::array{0.0, 0.0, 0.0});
      return {factor[0], factor[1], factor[2], 1};
    }
  }
  return {};
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

MaterialTexture read_texture(const Document& document, const Json& material, MaterialSlot slot) {
  MaterialTexture result;
  const auto* info = find_texture_info(material, slot);
  if (info == nullptr) {
    if (slot == MaterialSlot::base_color) return result;
    result = read_texture(document, material, MaterialSlot::base_color);
    result.texture = result.image = std::nullopt;
    return result;
  }
  result.texture = index_of(*info, "index");
  const auto& texture = document.json["textures"][*result.texture];
  result.image = image_of_texture(texture);
  const auto [wrap_u, wrap_v] = read_wrap_modes(document, texture);
  result.wrap_u = wrap_u;
  result.wrap_v = wrap_v;
  return result;
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
  const MaterialTexture base = read_texture(document, entry, MaterialSlot::base_color);
  material.texture = base.texture;
  material.image = base.image;
  material.wrap_u = base.wrap_u;
  material.wrap_v = base.wrap_v;
  return material;
}

std::array<WrapMode, 2> read_wrap_modes(const Document& document, const Json& texture) {
  const auto sampler = index_of(texture, "sampler");
  if (!sampler) return {WrapMode::repeat, WrapMode::repeat};
  const auto& entry = document.json["samplers"][*sampler];
  return {read_wrap(entry, "wrapS"), read_wrap(entry, "wrapT")};
}

bool magnifies_nearest(const Document& document, const Json& texture) {
  constexpr std::size_t nearest = 9728;
  const auto sampler = index_of(texture, "sampler");
  return sampler && index_of(document.json["samplers"][*sampler], "magFilter") == nearest;
}

}  // namespace applique
