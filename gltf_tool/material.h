#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "document.h"
#include "model.h"

namespace applique {

/// Which texture coordinates a material's base colour uses, and KHR_texture_transform.
struct UvMapping {
  std::size_t set = 0;
  std::array<double, 2> offset = {0, 0};
  std::array<double, 2> scale = {1, 1};
  double rotation = 0;

  /// The extension's matrix T R S; its angles are counter-clockwise as seen, with v down.
  [[nodiscard]] std::array<double, 2> apply(const std::array<double, 2>& uv) const;

  bool operator==(const UvMapping&) const = default;
};

/// The mapping of a material of a checked document; that of TEXCOORD_0 where it has no base-colour texture.
UvMapping read_uv_mapping(const Document::Json& material);

/// The mapping of one texture reference ({"index": …, "texCoord": …}) of a material.
UvMapping read_texture_mapping(const Document::Json& reference);

/// The image of a texture that can be decoded here: WebP where offered, else the core one; KTX2 and DDS only
/// where alone.
std::optional<std::size_t> image_of_texture(const Document::Json& texture);

/// The wrap modes of a texture.
std::array<WrapMode, 2> read_wrap_modes(const Document& document, const Document::Json& texture);

/// How a material of a checked document shows its base colour.
ModelMaterial read_material(const Document& document, const Document::Json& material);

}  // namespace applique
