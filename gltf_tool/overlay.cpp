#include "overlay.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

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
                   {"type", fmt::format("VEC{}", N)}};
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

/// JOINTS_n and WEIGHTS_n.
void add_influences(Document& document, const OverlayMesh& overlay, Json& attributes) {
  const std::size_t per_vertex = overlay.influences_per_vertex;
  const bool narrow = std::all_of(overlay.influences.begin(), overlay.influences.end(),
                                  [](const Influence& influence) { return influence.joint <= 0xff; });
  for (std::size_t set = 0; set < per_vertex / 4; ++set) {
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint16_t> words;
    std::vector<std::array<float, 4>> weights(overlay.positions.size());
    for (std::size_t v = 0; v < weights.size(); ++v)
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& [joint, weight] = overlay.influences[v * per_vertex + 4 * set + i];
        weights[v][i] = static_cast<float>(weight);
        if (narrow)
          bytes.push_back(static_cast<std::uint8_t>(joint));
        else
          words.push_back(static_cast<std::uint16_t>(joint));
      }
    const std::size_t joints =
        add_buffer_view(document, narrow ? as_bytes_of(bytes) : as_bytes_of(words), array_buffer);
    attributes[fmt::format("JOINTS_{}", set)] = add_to(document, "accessors",
                                                       {{"bufferView", joints},
                                                        {"componentType", narrow ? 5121 : 5123},
                                                        {"count", weights.size()},
                                                        {"type", "VEC4"}});
    const std::size_t view = add_buffer_view(document, as_bytes_of(weights), array_buffer);
    attributes[fmt::format("WEIGHTS_{}", set)] =
        add_to(document, "accessors",
               {{"bufferView", view}, {"componentType", 5126}, {"count", weights.size()}, {"type", "VEC4"}});
  }
}

Json add_targets(Document& document, const OverlayMesh& overlay) {
  Json targets = Json::array();
  for (const MorphTarget& target : overlay.targets) {
    Json attributes = Json::object();
    if (!target.positions.empty())
      attributes["POSITION"] = add_attribute<3>(document, target.positions, true);
    if (!target.normals.empty()) attributes["NORMAL"] = add_attribute<3>(document, target.normals, false);
    targets.push_back(std::move(attributes));
  }
  return targets;
}

/// The weights and the names of the targets are the mesh's own.
void copy_target_properties(const Json& from, Json& mesh) {
  if (from.contains("weights")) mesh["weights"] = from["weights"];
  if (const auto* names = find(from, {"extras", "targetNames"})) mesh["extras"]["targetNames"] = *names;
}

/// The target of an animation's channel, turned from a node's morph targets to the overlay's; none where it
/// is about anything else.
std::optional<Json> retarget(const Json& channel, std::size_t node, std::size_t overlay) {
  const auto* target = find(channel, {"target"});
  const auto* path = target != nullptr ? find(*target, {"path"}) : nullptr;
  if (path == nullptr || !path->is_string()) return std::nullopt;
  Json turned = *target;
  if (*path == "weights" && index_of(*target, "node") == node) {
    turned["node"] = overlay;
    return turned;
  }
  const auto* pointer = find(*target, {"extensions", "KHR_animation_pointer", "pointer"});
  if (*path != "pointer" || pointer == nullptr || !pointer->is_string()) return std::nullopt;
  const auto text = pointer->get<std::string>();
  const std::string weights = fmt::format("/nodes/{}/weights", node);
  if (text != weights && !text.starts_with(weights + "/")) return std::nullopt;
  turned["extensions"]["KHR_animation_pointer"]["pointer"] =
      fmt::format("/nodes/{}/weights{}", overlay, text.substr(weights.size()));
  return turned;
}

void animate_targets(Document& document, std::size_t node, std::size_t overlay) {
  if (!document.json.contains("animations")) return;
  for (auto& animation : document.json["animations"]) {
    if (!animation.contains("channels") || !animation["channels"].is_array()) continue;
    Json added = Json::array();
    for (const auto& channel : animation["channels"]) {
      auto target = retarget(channel, node, overlay);
      if (!target) continue;
      added.push_back(channel);
      added.back()["target"] = std::move(*target);
    }
    for (auto& channel : added) animation["channels"].push_back(std::move(channel));
  }
}

/// Below the node it follows, or at the root: a skinned mesh does not move with its node and is to have no
/// parent.
void place_node(Document& document, const OverlayMesh& overlay, std::size_t added) {
  auto& nodes = document.json["nodes"];
  if (overlay.node) {
    const Json& followed = nodes[*overlay.node];
    if (!overlay.targets.empty() && followed.contains("weights"))
      nodes[added]["weights"] = followed["weights"];
    if (overlay.influences_per_vertex == 0) {
      if (overlay.mirrored) nodes[added]["scale"] = {-1, 1, 1};
      nodes[*overlay.node]["children"].push_back(added);
      return;
    }
    nodes[added]["skin"] = followed["skin"];
  }
  if (count_of(document, "scenes") != 0)
    document.json["scenes"][index_of(document.json, "scene").value_or(0)]["nodes"].push_back(added);
}

}  // namespace

std::size_t add_overlay_material(Document& document, const std::string& decal,
                                 const OverlayMaterial& material) {
  const std::size_t sampler = add_to(
      document, "samplers", {{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33071}});
  Json pbr = {{"metallicFactor", material.metallic}, {"roughnessFactor", material.roughness}};
  Json entry = {{"name", decal}};
  for (const auto& [slot, bytes] : material.textures) {
    const bool base = slot == MaterialSlot::base_color;
    const std::size_t image =
        add_image(document, bytes, base ? decal : fmt::format("{}-{}", decal, name_of(slot)));
    const std::size_t texture = add_to(document, "textures", {{"sampler", sampler}});
    show_image(document, texture, image);
    const bool in_pbr = base || slot == MaterialSlot::metallic_roughness;
    (in_pbr ? pbr : entry)[fmt::format("{}Texture", name_of(slot))] = {{"index", texture}};
  }
  entry["pbrMetallicRoughness"] = std::move(pbr);
  if (material.emissive != std::array{0.0, 0.0, 0.0}) entry["emissiveFactor"] = material.emissive;
  entry["alphaMode"] = "BLEND";
  entry["doubleSided"] = false;
  entry["extras"] = {{"applique", {{"layers", material.layers}}}};
  return add_to(document, "materials", std::move(entry));
}

std::size_t add_overlay(Document& document, const std::string& decal, const OverlayMesh& overlay,
                        std::size_t material) {
  const Json extras = {{"applique", {{"decal", decal}}}};
  Json attributes = {{"POSITION", add_attribute<3>(document, overlay.positions, true)}};
  attributes["NORMAL"] = add_attribute<3>(document, overlay.normals, false);
  attributes["TEXCOORD_0"] = add_attribute<2>(document, overlay.uvs, false);
  if (!overlay.tangents.empty()) attributes["TANGENT"] = add_attribute<4>(document, overlay.tangents, false);
  add_influences(document, overlay, attributes);
  Json primitive = {{"attributes", std::move(attributes)}, {"indices", add_indices(document, overlay)}};
  primitive["material"] = material;
  primitive["mode"] = 4;
  if (!overlay.targets.empty()) primitive["targets"] = add_targets(document, overlay);
  Json mesh = {{"name", decal}, {"primitives", Json::array({std::move(primitive)})}, {"extras", extras}};
  if (!overlay.targets.empty()) {
    const auto& followed = document.json["nodes"][*overlay.node];
    copy_target_properties(document.json["meshes"][followed["mesh"].get<std::size_t>()], mesh);
  }
  const std::size_t mesh_index = add_to(document, "meshes", std::move(mesh));
  const std::size_t node =
      add_to(document, "nodes", {{"name", decal}, {"mesh", mesh_index}, {"extras", extras}});
  place_node(document, overlay, node);
  if (!overlay.targets.empty()) animate_targets(document, *overlay.node, node);
  return node;
}

}  // namespace applique
