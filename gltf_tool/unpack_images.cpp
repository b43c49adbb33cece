#include "unpack_images.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "binary_edit.h"
#include "edit.h"
#include "media_type.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Whether every extension is known to name buffer views by the key "bufferView" only. Khronos' own do.
bool names_views_plainly(const Json& extension) {
  constexpr std::array<std::string_view, 7> plain = {
      "EXT_texture_webp",  "EXT_meshopt_compression", "EXT_mesh_gpu_instancing",
      "EXT_mesh_features", "EXT_lights_image_based",  "MSFT_texture_dds",
      "MSFT_lod"};
  if (!extension.is_string()) return false;
  const std::string name = extension.get<std::string>();
  return name.starts_with("KHR_") || std::find(plain.begin(), plain.end(), name) != plain.end();
}

std::size_t count_view_uses(const Json& json, std::size_t view) {
  std::size_t uses = json.is_object() && index_of(json, "bufferView") == view ? 1 : 0;
  if (json.is_structured())
    for (const auto& member : json) uses += count_view_uses(member, view);
  return uses;
}

void unpack_image(Document& document, std::size_t image) {
  const auto view = index_of(document.json["images"][image], "bufferView");
  if (!view || document.json["bufferViews"][*view]["buffer"] != *document.chunk_buffer ||
      count_view_uses(document.json, *view) != 1)
    return;
  const auto bytes = read_image_bytes(document, image);
  if (!bytes || media_type_of(*bytes).empty()) return;
  auto& entry = document.json["images"][image];
  const auto* name = find(entry, {"name"});
  entry["uri"] = add_file(document, *bytes,
                          name != nullptr && name->is_string() ? name->get<std::string>() : std::string());
  entry.erase("bufferView");
  remove_buffer_view(document, *view);
}

}  // namespace

void unpack_images(Document& document) {
  const auto* extensions = find(document.json, {"extensionsUsed"});
  if (!document.chunk_buffer ||
      (extensions != nullptr && !std::all_of(extensions->begin(), extensions->end(), names_views_plainly)))
    return;
  for (std::size_t i = 0; i < count_of(document, "images"); ++i) unpack_image(document, i);
}

}  // namespace applique
