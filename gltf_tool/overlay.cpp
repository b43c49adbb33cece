#include "overlay.h"

#include <algorithm>
#include <limits>

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

/// `items` as floats, with min and max where asked for.
template <std::size_t N, class Item>
std::size_t add_attribute(Document& document, const std::vector<Item>& items, bool bounds) {
  std::vector<std::array<float, N>> values(items.size());
  std::array<float, N> lower;
  std::array<float, N> upper;
  lower.fill(std::numeric_limits<float>::max());
  upper.fill(std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::size_t c = 0; c < N; ++c) {
      values[i][c] = static_cast<float>(items[i][c]);
      lower[c] = std::min(lower[c], values[i][c]);
      upper[c] = std::max(upper[c], values[i][c]);
    }
  Json accessor = {{"bufferView", add_buffer_view(document, as_bytes_of(values), array_buffer)},
                   {"componentType", 5126},
                   {"count", items.size()},
                   {"type", N == 2 ? "VEC2" : "VEC3"}};
  if (bounds) {
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

std::size_t add_material(Document& document, const std::string& name,
                         std::span<const std::uint8_t> image_bytes) {
  const std::size_t image = add_image(document, image_bytes, name);
  const std::size_t sampler = add_to(
      document, "samplers", {{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33071}});
  const std::size_t texture = add_to(document, "textures", {{"sampler", sampler}});
  show_image(document, texture, image);
  Json pbr = {{"baseColorTexture", {{"index", texture}}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
  return add_to(document, "materials",
                {{"name", name},
                 {"pbrMetallicRoughness", std::move(pbr)},
                 {"alphaMode", "BLEND"},
                 {"doubleSided", false}});
}

}  // namespace

std::size_t add_overlay(Document& document, const std::string& decal, const OverlayMesh& overlay,
                        std::span<const std::uint8_t> image_bytes) {
  const Json extras = {{"applique", {{"decal", decal}}}};
  Json attributes = {{"POSITION", add_attribute<3>(document, overlay.positions, true)}};
  attributes["NORMAL"] = add_attribute<3>(document, overlay.normals, false);
  attributes["TEXCOORD_0"] = add_attribute<2>(document, overlay.uvs, false);
  Json primitive = {{"attributes", std::move(attributes)}, {"indices", add_indices(document, overlay)}};
  primitive["material"] = add_material(document, decal, image_bytes);
  primitive["mode"] = 4;
  const std::size_t mesh =
      add_to(document, "meshes",
             {{"name", decal}, {"primitives", Json::array({std::move(primitive)})}, {"extras", extras}});
  const std::size_t node = add_to(document, "nodes", {{"name", decal}, {"mesh", mesh}, {"extras", extras}});
  if (count_of(document, "scenes") != 0)
    document.json["scenes"][index_of(document.json, "scene").value_or(0)]["nodes"].push_back(node);
  return node;
}

}  // namespace applique
