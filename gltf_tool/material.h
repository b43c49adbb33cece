#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "document.h"
#include "model.h"

namespace applique {

/// A texture of glTF's core material that a decal can be baked into.
enum class MaterialSlot : std::uint32_t { base_color, metallic_roughness, normal, occlusion, emissive };
inline constexpr std::array all_slots = {MaterialSlot::base_color, MaterialSlot::metallic_roughness,
                                         MaterialSlot::normal, MaterialSlot::occlusion,
                                         MaterialSlot::emissive};
/// As jobs and reports call it: "baseColor".
const char* name_of(MaterialSlot slot);

/// The slot's textureInfo in a material; null if it has none.
const Document::Json* find_texture_info(const Document::Json& material, MaterialSlot slot);

/// Which texture coordinates a texture uses, and KHR_texture_transform.
struct UvMapping {
  std::size_t set = 0;
  std::array<double, 2> offset = {0, 0};
  std::array<double, 2> scale = {1, 1};
  double rotation = 0;

  /// The extension's matrix T R S; its angles are counter-clockwise as seen, with v down.
  [[nodiscard]] std::array<double, 2> apply(const std::array<double, 2>& uv) const;
  bool operator==(const UvMapping&) const = default;
};

/// The mapping of a slot of a checked document's material. Without a texture there, it is the one that a
/// texture made for it would have: that of the base colour or, without that too, TEXCOORD_0 as it is.
UvMapping read_uv_mapping(const Document::Json& material, MaterialSlot slot = MaterialSlot::base_color);

/// A texture as a material shows it.
struct MaterialTexture {
  std::optional<std::size_t> texture;  ///< Document index; none: the slot has no texture.
  std::optional<std::size_t> image;    ///< Document index of the image behind it.
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
};
/// The slot of a checked document's material. Without a texture there, the wrap modes are those of the base
/// colour's.
MaterialTexture read_texture(const Document& document, const Document::Json& material, MaterialSlot slot);

/// What a material's factors make of a slot without a texture: linear light, or numbers; a flat normal as
/// textures store it; 1 in channels that nothing reads.
std::array<double, 4> read_factors(const Document::Json& material, MaterialSlot slot);

/// The mapping of one texture reference ({"index": …, "texCoord": …}) of a material.
UvMapping read_texture_mapping(const Document::Json& reference);

/// The image of a texture that can be decoded here: WebP where offered, else the core one; KTX2 and DDS only
/// where alone.
std::optional<std::size_t> image_of_texture(const Document::Json& texture);

/// The wrap modes of a texture of a checked document.
std::array<WrapMode, 2> read_wrap_modes(const Document& document, const Document::Json& texture);

/// Whether the sampler of a texture of a checked document magnifies without interpolation.
bool magnifies_nearest(const Document& document, const Document::Json& texture);

/// How a material of a checked document shows its base colour.
ModelMaterial read_material(const Document& document, const Document::Json& material);

}  // namespace applique
