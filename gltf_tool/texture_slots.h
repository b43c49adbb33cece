#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "document.h"
#include "edit.h"
#include "material.h"

namespace applique {

/// What a texture's texels are, which says how they are averaged.
enum class TexelContent {
  colour,  ///< sRGB: averaged in linear light.
  data,    ///< As they are.
  normal,  ///< Directions in the tangent frame, in red and green: turned with the frame.
};

/// A texture that a material shows in one slot, or in several through the same texture coordinates.
struct TextureSlots {
  std::vector<SlotPointer> slots;
  std::string name;  ///< The first slot's: "normalTexture".
  std::size_t texture = 0;
  UvMapping mapping;
  TexelContent content = TexelContent::data;
};

/// A slot of the core material.
SlotPointer pointer_to(MaterialSlot slot);

/// All textures of a material of a checked document, those of its extensions too.
std::vector<TextureSlots> find_texture_slots(const Document::Json& material);

}  // namespace applique
