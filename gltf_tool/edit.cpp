#include "edit.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "binary_edit.h"
#include "media_type.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Extensions by which a texture names another image than its own source.
constexpr std::array<const char*, 3> source_extensions = {"EXT_texture_webp", "KHR_texture_basisu",
                                                          "MSFT_texture_dds"};

/// Gives every touched node a mesh of its own. Returns the mesh of each part.
std::vector<std::size_t> isolate_meshes(Document& document, std::span<const PartKey> parts) {
  std::map<std::size_t, std::vector<std::size_t>> users;  // mesh -> nodes
  auto& nodes = document.json["nodes"];
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (const auto mesh = index_of(nodes[n], "mesh")) users[*mesh].push_back(n);
  std::set<std::size_t> touched;
  for (const PartKey& part : parts)
    if (!part.every_node) touched.insert(part.node);
  std::map<std::size_t, std::size_t> mesh_of;  // touched node -> its mesh
  for (const auto& [mesh, sharers] : users) {
    // The original stays with the untouched nodes; where there are none, with the first.
    bool original_taken =
        std::any_of(sharers.begin(), sharers.end(), [&](std::size_t n) { return !touched.contains(n); });
    for (const std::size_t node : sharers) {
      if (!touched.contains(node)) continue;
      mesh_of[node] = mesh;
      if (std::exchange(original_taken, true)) {
        auto& meshes = document.json["meshes"];
        Json copy = meshes[mesh];
        mesh_of[node] = meshes.size();
        meshes.push_back(std::move(copy));
        nodes[node]["mesh"] = mesh_of[node];
      }
    }
  }
  std::vector<std::size_t> result;
  for (const PartKey& part : parts) result.push_back(part.every_node ? part.mesh : mesh_of.at(part.node));
  return result;
}

}  // namespace

std::vector<std::size_t> instance_ranks(std::span<const PartKey> parts) {
  // mesh -> touched nodes; all others together are the first.
  std::map<std::size_t, std::set<std::optional<std::size_t>>> instances;
  const auto instance_of = [](const PartKey& part) {
    return part.every_node ? std::nullopt : std::optional(part.node);
  };
  for (const PartKey& part : parts) instances[part.mesh].insert(instance_of(part));
  std::vector<std::size_t> ranks;
  for (const PartKey& part : parts) {
    const auto& set = instances[part.mesh];
    ranks.push_back(static_cast<std::size_t>(std::distance(set.begin(), set.find(instance_of(part)))));
  }
  return ranks;
}

void lead_variants(Json& primitive, std::size_t from, std::size_t to) {
  if (find(primitive, {"extensions", "KHR_materials_variants", "mappings"}) == nullptr) return;
  auto& mappings = primitive["extensions"]["KHR_materials_variants"]["mappings"];
  if (!mappings.is_array()) return;
  for (auto& mapping : mappings)
    if (index_of(mapping, "material") == from) mapping["material"] = to;
}

namespace {

/// How often a primitive uses a material: itself and by its variants.
std::size_t count_uses_in(const Json& primitive, std::size_t material) {
  std::size_t uses = index_of(primitive, "material") == material ? 1 : 0;
  const auto* mappings = find(primitive, {"extensions", "KHR_materials_variants", "mappings"});
  if (mappings == nullptr || !mappings->is_array()) return uses;
  for (const auto& mapping : *mappings) uses += index_of(mapping, "material") == material ? 1 : 0;
  return uses;
}

/// How often the document's meshes use a material, by primitives and by variants.
std::map<std::size_t, std::size_t> count_material_uses(const Document& document) {
  std::map<std::size_t, std::size_t> uses;
  for (const auto& mesh : document.json["meshes"])
    for (const auto& primitive : mesh["primitives"]) {
      if (const auto material = index_of(primitive, "material")) ++uses[*material];
      const auto* mappings = find(primitive, {"extensions", "KHR_materials_variants", "mappings"});
      if (mappings == nullptr || !mappings->is_array()) continue;
      for (const auto& mapping : *mappings)
        if (const auto material = index_of(mapping, "material")) ++uses[*material];
    }
  return uses;
}

/// Calls `function` with every texture reference in a material: the objects under keys that end in "Texture".
template <class Function>
void each_texture_reference(const Json& object, Function function) {
  if (!object.is_object()) return;
  for (const auto& item : object.items()) {
    if (item.key().ends_with("Texture") && index_of(item.value(), "index")) function(item.value());
    each_texture_reference(item.value(), function);
  }
}

std::size_t count_texture_uses(const Document& document, std::size_t texture) {
  std::size_t uses = 0;
  for (const auto& material : document.json["materials"])
    each_texture_reference(material, [&](const Json& reference) {
      if (index_of(reference, "index") == texture) ++uses;
    });
  return uses;
}

/// Calls `function` with every object of a texture that has a "source".
template <class Function>
void each_source(Json& texture, Function function) {
  if (texture.contains("source")) function(texture);
  for (const char* extension : source_extensions)
    if (find(texture, {"extensions", extension, "source"}) != nullptr)
      function(texture["extensions"][extension]);
}

/// Whether a texture other than `texture` shows the image.
bool is_shown_elsewhere(Document& document, std::size_t image, std::size_t texture) {
  bool shown = false;
  auto& textures = document.json["textures"];
  for (std::size_t i = 0; i < textures.size(); ++i)
    if (i != texture)
      each_source(textures[i],
                  [&](const Json& object) { shown = shown || index_of(object, "source") == image; });
  return shown;
}

/// Takes an image that nothing uses out of the list, unless something here unknown may count images.
void remove_image(Document& document, std::size_t image) {
  if (find(document.json, {"extensions", "EXT_lights_image_based"}) != nullptr) return;
  document.json["images"].erase(image);
  for (auto& texture : document.json["textures"])
    each_source(texture, [&](Json& object) {
      const std::size_t source = object["source"].get<std::size_t>();
      if (source > image) object["source"] = source - 1;
    });
}

/// Replaces an image's bytes and keeps its other members.
void replace_image(Document& document, std::size_t image, std::span<const std::uint8_t> bytes,
                   const std::string& fallback) {
  auto& entry = document.json["images"][image];
  const auto view = index_of(entry, "bufferView");
  if (view && count_view_uses(document, *view) == 1) {
    replace_buffer_view(document, *view, bytes);
    document.json["images"][image]["mimeType"] = media_type_of(bytes);
    return;
  }
  const auto* name = find(entry, {"name"});
  const std::size_t added =
      add_image(document, bytes, name != nullptr && name->is_string() ? name->get<std::string>() : fallback);
  auto& images = document.json["images"];
  Json replacement = std::move(images[added]);
  images.erase(added);
  for (const char* key : {"name", "extras", "extensions"}) {
    replacement.erase(key);
    if (images[image].contains(key)) replacement[key] = images[image][key];
  }
  images[image] = std::move(replacement);
}

/// Puts a name on one of the document's lists of extensions.
void declare(Document& document, const char* list, const char* extension) {
  auto& names = document.json[list];
  if (std::find(names.begin(), names.end(), extension) == names.end()) names.push_back(extension);
}

bool is_webp(const Json& image) {
  const auto* media_type = find(image, {"mimeType"});
  const auto* uri = find(image, {"uri"});
  return (media_type != nullptr && *media_type == "image/webp") ||
         (uri != nullptr && uri->get<std::string>().ends_with(".webp"));
}

/// Takes EXT_texture_webp off the lists of extensions when the last WebP is gone, so that every viewer may
/// show the model.
void forget_webp(Document& document) {
  const auto& images = document.json["images"];
  if (std::any_of(images.begin(), images.end(), is_webp)) return;
  for (const auto& texture : document.json["textures"])
    if (find(texture, {"extensions", "EXT_texture_webp"}) != nullptr) return;
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!document.json.contains(list)) continue;
    auto& names = document.json[list];
    names.erase(std::remove(names.begin(), names.end(), "EXT_texture_webp"), names.end());
    if (names.empty()) document.json.erase(list);
  }
}

/// A textureInfo and a texture, both without what they show, over the coordinates and with the sampler of the
/// base colour's.
std::pair<Json, Json> like_base_colour(const Document& document, const Json& material) {
  Json info = Json::object(), texture = Json::object();
  const auto* base = find_texture_info(material, MaterialSlot::base_color);
  if (base == nullptr) return {info, texture};
  if (base->contains("texCoord")) info["texCoord"] = base->at("texCoord");
  if (const auto* transform = find(*base, {"extensions", "KHR_texture_transform"}))
    info["extensions"]["KHR_texture_transform"] = *transform;
  const auto& shown = document.json["textures"][base->at("index").get<std::size_t>()];
  if (shown.contains("sampler")) texture["sampler"] = shown["sampler"];
  return {info, texture};
}

/// What multiplies the slot's texture becomes 1.
void drop_factors(Json& material, MaterialSlot slot) {
  if (slot == MaterialSlot::base_color) material["pbrMetallicRoughness"].erase("baseColorFactor");
  if (slot == MaterialSlot::metallic_roughness)
    for (const char* factor : {"metallicFactor", "roughnessFactor"})
      material["pbrMetallicRoughness"].erase(factor);
  if (slot == MaterialSlot::emissive) material["emissiveFactor"] = {1, 1, 1};
}

/// The texture's only source becomes an image of these bytes: in place of an image that it alone uses, else a
/// new one.
void set_texture_image(Document& document, std::size_t texture, std::span<const std::uint8_t> bytes,
                       const std::string& name) {
  std::vector<std::size_t> own;
  auto& entry = document.json["textures"][texture];
  each_source(entry, [&](const Json& object) {
    const std::size_t image = object["source"].get<std::size_t>();
    if (std::find(own.begin(), own.end(), image) == own.end()) own.push_back(image);
  });
  std::erase_if(own, [&](std::size_t image) { return is_shown_elsewhere(document, image, texture); });
  std::sort(own.begin(), own.end());
  if (own.empty()) {
    show_image(document, texture, add_image(document, bytes, name));
    return;
  }
  replace_image(document, own.front(), bytes, name);
  show_image(document, texture, own.front());
  for (std::size_t i = own.size(); i-- > 1;) remove_image(document, own[i]);
  forget_webp(document);
}

}  // namespace

std::vector<std::size_t> isolate_materials(Document& document, std::span<const PartKey> parts) {
  const std::vector<std::size_t> meshes = isolate_meshes(document, parts);
  const std::vector<std::size_t> ranks = instance_ranks(parts);
  // Parts of one group keep sharing one material: (original material or none, instance rank).
  using Group = std::pair<std::optional<std::size_t>, std::size_t>;
  std::map<Group, std::vector<std::size_t>> groups;
  const auto primitive_of = [&](std::size_t i) -> Json& {
    return document.json["meshes"][meshes[i]]["primitives"][parts[i].primitive];
  };
  for (std::size_t i = 0; i < parts.size(); ++i)
    groups[{index_of(primitive_of(i), "material"), ranks[i]}].push_back(i);

  const auto uses = count_material_uses(document);
  std::map<std::size_t, std::size_t> touched_uses;
  for (const auto& [group, members] : groups)
    if (group.first)
      for (const std::size_t i : members)
        touched_uses[*group.first] += count_uses_in(primitive_of(i), *group.first);
  std::set<std::size_t> taken;
  std::vector<std::size_t> result(parts.size());
  for (const auto& [group, members] : groups) {
    auto& materials = document.json["materials"];
    std::size_t material = group.first.value_or(0);
    if (!group.first) {
      material = materials.size();
      materials.push_back({{"pbrMetallicRoughness", Json::object()}});
    } else if (uses.at(material) != touched_uses.at(material) || !taken.insert(material).second) {
      Json copy = materials[material];
      material = materials.size();
      materials.push_back(std::move(copy));
    }
    for (const std::size_t i : members) {
      primitive_of(i)["material"] = material;
      if (group.first) lead_variants(primitive_of(i), *group.first, material);
      result[i] = material;
    }
  }
  return result;
}

std::string add_file(Document& document, std::span<const std::uint8_t> bytes, const std::string& name) {
  std::string stem = name.empty() ? "image" : name;
  for (char& c : stem)
    if (std::string_view("/\\:*?\"<>|%").find(c) != std::string_view::npos) c = '_';
  const std::string extension = extension_of(media_type_of(bytes));
  std::string uri = stem + extension;
  for (int i = 2; document.new_files.contains(uri); ++i) uri = fmt::format("{}_{}{}", stem, i, extension);
  document.new_files[uri].assign(bytes.begin(), bytes.end());
  return uri;
}

std::size_t add_image(Document& document, std::span<const std::uint8_t> bytes, const std::string& name) {
  Json image = {{"mimeType", media_type_of(bytes)}, {"name", name}};
  if (document.is_glb)
    image["bufferView"] = add_buffer_view(document, bytes);
  else
    image["uri"] = add_file(document, bytes, name);
  auto& images = document.json["images"];
  images.push_back(std::move(image));
  return images.size() - 1;
}

void show_image(Document& document, std::size_t texture, std::size_t image) {
  const bool webp = is_webp(document.json["images"][image]);
  auto& entry = document.json["textures"][texture];
  if (entry.contains("extensions"))
    for (const char* extension : source_extensions) entry["extensions"].erase(extension);
  if (webp) {
    entry.erase("source");
    entry["extensions"]["EXT_texture_webp"]["source"] = image;
  } else {
    entry["source"] = image;
  }
  if (entry.contains("extensions") && entry["extensions"].empty()) entry.erase("extensions");
  // Last: a list that is new moves all of the document's members, and `entry` with them.
  if (webp)
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
      declare(document, list, "EXT_texture_webp");
}

void set_slot_image(Document& document, std::size_t material, MaterialSlot slot,
                    std::span<const std::uint8_t> bytes) {
  auto& textures = document.json["textures"];
  auto& entry = document.json["materials"][material];
  const bool in_pbr = slot == MaterialSlot::base_color || slot == MaterialSlot::metallic_roughness;
  auto& owner = in_pbr ? entry["pbrMetallicRoughness"] : entry;
  const std::string key = name_of(slot) + std::string("Texture");
  if (!owner.contains(key)) {
    auto [info, texture] = like_base_colour(document, entry);
    info["index"] = textures.size();
    owner[key] = std::move(info);
    textures.push_back(std::move(texture));
  }
  std::size_t texture = owner[key]["index"].get<std::size_t>();
  bool has_image = false;
  each_source(textures[texture], [&](const Json&) { has_image = true; });
  if (!has_image) drop_factors(entry, slot);
  if (count_texture_uses(document, texture) > 1) {
    Json copy = textures[texture];
    texture = textures.size();
    textures.push_back(std::move(copy));
    owner[key]["index"] = texture;
  }
  set_texture_image(document, texture, bytes, name_of(slot));
}

void set_slot_images(Document& document, std::size_t material, const std::vector<SlotPointer>& slots,
                     std::span<const std::uint8_t> bytes, const std::string& name) {
  auto& entry = document.json["materials"][material];
  auto& textures = document.json["textures"];
  std::size_t texture = entry[slots.front()]["index"].get<std::size_t>();
  if (count_texture_uses(document, texture) > slots.size()) {
    Json copy = textures[texture];
    texture = textures.size();
    textures.push_back(std::move(copy));
  }
  for (const SlotPointer& slot : slots) entry[slot]["index"] = texture;
  set_texture_image(document, texture, bytes, name);
}

}  // namespace applique
