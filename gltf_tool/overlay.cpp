#include "overlay.h"

#include <algorithm>

#include "binary_edit.h"
#include "edit.h"

namespace applique {
namespace {

using Json = Document::Json;

constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;

template <class T>
std::span<const std::uint8_t> as_bytes_of(const std::vector<T>& items) {
  return {reinterpret_cast<const std::uint8_t*>(items.data()), items.size() * sizeof(T)};
}

std::size_t add_to(Document& document, const char* collection, Json entry) {
  auto& items = document.json[collection];
  items.push_back(std::move(entry));
  return items.size() - 1;
}

template <std::size_t N>
std::size_t add_attribute(Document& document, const std::vector<std::array<float, N>>& items, bool bounds) {
  Json accessor = {{"bufferView", add_buffer_view(document, as_bytes_of(items), array_buffer)},
                   {"componentType", 5126},
                   {"count", items.size()},
                   {"type", N == 2 ? "VEC2" : "VEC3"}};
  if (bounds) {
    auto lower = items.front();
    auto upper = items.front();
    for (const auto& item : items)
      for (std::size_t c = 0; c < N; ++c) {
        lower[c] = std::min(lower[c], item[c]);
        upper[c] = std::max(upper[c], item[c]);
      }
    accessor["min"] = std::vector<double>(lower.begin(), lower.end());
    accessor["max"] = std::vector<double>(upper.begin(), upper.end());
  }
  return add_to(document, "accessors", std::move(accessor));
}

std::size_t add_indices(Document& document, const OverlayMesh& overlay) {
  std::size_t view = 0;
  // 65535 would be the primitive restart value.
  const bool narrow = overlay.positions.size() <= 65535;
  if (narrow) {
    std::vector<std::uint16_t> indices;
    for (const auto& triangle : overlay.triangles)
      for (const std::uint32_t corner : triangle) indices.push_back(static_cast<std::uint16_t>(corner));
    view = add_buffer_view(document, as_bytes_of(indices), element_array_buffer);
  } else {
    view = add_buffer_view(document, as_bytes_of(overlay.triangles), element_array_buffer);
  }
  return add_to(document, "accessors",
                {{"bufferView", view},
                 {"componentType", narrow ? 5123 : 5125},
                 {"count", 3 * overlay.triangles.size()},
                 {"type", "SCALAR"}});
}

std::size_t add_material(Document& document, const std::string& name, std::span<const std::uint8_t> png,
                         double opacity) {
  const std::size_t image = add_image(document, png, name);
  const std::size_t sampler = add_to(
      document, "samplers", {{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33071}});
  const std::size_t texture = add_to(document, "textures", {{"sampler", sampler}, {"source", image}});
  Json pbr = {{"baseColorTexture", {{"index", texture}}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
  if (opacity < 1) pbr["baseColorFactor"] = {1.0, 1.0, 1.0, opacity};
  return add_to(document, "materials",
                {{"name", name},
                 {"pbrMetallicRoughness", std::move(pbr)},
                 {"alphaMode", "BLEND"},
                 {"doubleSided", false}});
}

}  // namespace

std::size_t add_overlay(Document& document, const OverlayMesh& overlay, std::span<const std::uint8_t> png,
                        double opacity) {
  const Json extras = {{"applique", {{"decal", overlay.name}}}};
  Json attributes = {{"POSITION", add_attribute(document, overlay.positions, true)}};
  attributes["NORMAL"] = add_attribute(document, overlay.normals, false);
  attributes["TEXCOORD_0"] = add_attribute(document, overlay.uvs, false);
  Json primitive = {{"attributes", std::move(attributes)}, {"indices", add_indices(document, overlay)}};
  primitive["material"] = add_material(document, overlay.name, png, opacity);
  primitive["mode"] = 4;
  const std::size_t mesh = add_to(
      document, "meshes",
      {{"name", overlay.name}, {"primitives", Json::array({std::move(primitive)})}, {"extras", extras}});
  const std::size_t node =
      add_to(document, "nodes", {{"name", overlay.name}, {"mesh", mesh}, {"extras", extras}});
  if (count_of(document, "scenes") != 0)
    document.json["scenes"][index_of(document.json, "scene").value_or(0)]["nodes"].push_back(node);
  return node;
}

}  // namespace applique
