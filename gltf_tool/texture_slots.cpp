#include "texture_slots.h"

#include <algorithm>
#include <string_view>

namespace applique {
namespace {

using Json = Document::Json;

/// By the name of the slot, in the core and in the Khronos material extensions.
TexelContent content_of(std::string_view slot) {
  for (const std::string_view normal : {"normalTexture", "clearcoatNormalTexture", "anisotropyTexture"})
    if (slot == normal) return TexelContent::normal;
  for (const std::string_view colour : {"emissiveTexture", "diffuseTexture", "specularGlossinessTexture"})
    if (slot == colour) return TexelContent::colour;
  // Their values are in the alpha, which is never encoded; the colours beside them are another slot's.
  for (const std::string_view alpha : {"sheenRoughnessTexture", "specularTexture"})
    if (slot == alpha) return TexelContent::colour;
  return slot.find("Color") != std::string_view::npos ? TexelContent::colour : TexelContent::data;
}

void add_slots(const Json& object, const SlotPointer& place, std::vector<TextureSlots>& list) {
  for (const auto& item : object.items()) {
    if (!item.value().is_object() || item.key() == "extras") continue;
    const SlotPointer slot = place / item.key();
    const auto texture = index_of(item.value(), "index");
    if (!item.key().ends_with("Texture") || !texture) {
      add_slots(item.value(), slot, list);
      continue;
    }
    const UvMapping mapping = read_texture_mapping(item.value());
    const TexelContent content = content_of(item.key());
    const auto same = std::find_if(list.begin(), list.end(), [&](const TextureSlots& known) {
      return known.texture == *texture && known.mapping == mapping && known.content == content;
    });
    if (same != list.end())
      same->slots.push_back(slot);
    else
      list.push_back({{slot}, item.key(), *texture, mapping, content});
  }
}

}  // namespace

SlotPointer pointer_to(MaterialSlot slot) {
  const bool in_pbr = slot == MaterialSlot::base_color || slot == MaterialSlot::metallic_roughness;
  return SlotPointer(in_pbr ? "/pbrMetallicRoughness" : "") / (name_of(slot) + std::string("Texture"));
}

std::vector<TextureSlots> find_texture_slots(const Json& material) {
  std::vector<TextureSlots> list;
  add_slots(material, SlotPointer(), list);
  return list;
}

}  // namespace applique
