#include "binary_edit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>

#include "compression.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Puts bytes at the end of the chunk and says where.
std::pair<std::size_t, std::size_t> append(Document& document, std::span<const std::uint8_t> bytes) {
  auto& buffers = document.json["buffers"];
  auto& chunk = document.binary_chunk;
  if (!document.chunk_buffer) {
    // A chunk that no buffer of a GLB refers to would be taken for the new buffer's bytes.
    chunk.clear();
    document.chunk_buffer = buffers.size();
    buffers.push_back({{"byteLength", 0}});
  }
  auto& buffer = buffers[*document.chunk_buffer];
  chunk.resize((buffer["byteLength"].get<std::size_t>() + 3) / 4 * 4);
  const std::size_t offset = chunk.size();
  chunk.insert(chunk.end(), bytes.begin(), bytes.end());
  buffer["byteLength"] = chunk.size();
  return {*document.chunk_buffer, offset};
}

/// Calls `function` with every range of a buffer that a view or its compression takes.
template <class Function>
void each_range(Json& json, Function function) {
  for (auto& view : json["bufferViews"]) {
    function(view);
    if (!view.contains("extensions") || !view["extensions"].is_object()) continue;
    for (auto& extension : view["extensions"])
      if (extension.is_object() && extension.contains("buffer") && extension.contains("byteLength"))
        function(extension);
  }
}

std::size_t count_buffer_keys(const Json& json) {
  std::size_t count = 0;
  if (json.is_object()) count += json.count("buffer");
  if (json.is_structured())
    for (const auto& member : json) count += count_buffer_keys(member);
  return count;
}

/// Takes bytes that nothing refers to out of the chunk, in multiples of 4 so that all alignments stay.
void erase_unused(Document& document, std::size_t begin, std::size_t end) {
  begin = (begin + 3) / 4 * 4;
  if (begin >= end) return;
  const std::size_t removed = (end - begin) / 4 * 4;
  end = begin + removed;
  bool safe = true;
  std::size_t ranges = 0;
  const auto in_chunk = [&](const Json& range) {
    return range["buffer"].get<std::size_t>() == *document.chunk_buffer;
  };
  each_range(document.json, [&](Json& range) {
    ++ranges;
    const std::size_t first = index_of(range, "byteOffset").value_or(0);
    const std::size_t last = first + range["byteLength"].get<std::size_t>();
    if (in_chunk(range) && first < end && last > begin) safe = false;
  });
  if (!safe || ranges != count_buffer_keys(document.json)) return;
  each_range(document.json, [&](Json& range) {
    const std::size_t first = index_of(range, "byteOffset").value_or(0);
    if (in_chunk(range) && first >= end) range["byteOffset"] = first - removed;
  });
  auto& chunk = document.binary_chunk;
  chunk.erase(chunk.begin() + static_cast<std::ptrdiff_t>(begin),
              chunk.begin() + static_cast<std::ptrdiff_t>(end));
  auto& length = document.json["buffers"][*document.chunk_buffer]["byteLength"];
  length = length.get<std::size_t>() - removed;
}

/// Calls `function` with every member "bufferView" in the document.
template <class Function>
void each_view_reference(Json& json, const Function& function) {
  if (json.is_object() && index_of(json, "bufferView")) function(json["bufferView"]);
  if (json.is_structured())
    for (auto& member : json) each_view_reference(member, function);
}

/// Calls `function` with every member that names an accessor.
template <class Function>
void each_accessor_reference(Json& root, const Function& function) {
  const auto visit = [&](Json& object, const char* key) {
    if (index_of(object, key)) function(object[key]);
  };
  const auto visit_all = [&](Json& attributes) {
    for (auto& attribute : attributes)
      if (as_index(attribute)) function(attribute);
  };
  if (root.contains("meshes"))
    for (auto& mesh : root["meshes"])
      for (auto& primitive : mesh["primitives"]) {
        visit(primitive, "indices");
        visit_all(primitive["attributes"]);
        if (primitive.contains("targets"))
          for (auto& target : primitive["targets"]) visit_all(target);
      }
  if (root.contains("skins"))
    for (auto& skin : root["skins"]) visit(skin, "inverseBindMatrices");
  if (root.contains("animations"))
    for (auto& animation : root["animations"])
      if (animation.contains("samplers"))
        for (auto& sampler : animation["samplers"]) {
          visit(sampler, "input");
          visit(sampler, "output");
        }
  if (root.contains("nodes"))
    for (auto& node : root["nodes"])
      if (find(node, {"extensions", "EXT_mesh_gpu_instancing", "attributes"}) != nullptr)
        visit_all(node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]);
}

/// Whether all references to accessors are among those above.
bool knows_extensions(const Json& root) {
  const auto* used = find(root, {"extensionsUsed"});
  if (used == nullptr || !used->is_array()) return true;
  return std::all_of(used->begin(), used->end(), [](const Json& extension) {
    if (!extension.is_string()) return false;
    const auto name = extension.get<std::string>();
    for (const char* prefix : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"})
      if (name.starts_with(prefix)) return true;
    for (const char* known :
         {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
          "KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_xmp_json_ld", "KHR_animation_pointer"})
      if (name == known) return true;
    return false;
  });
}

void store_number(double value, std::size_t type, std::uint8_t* at) {
  const auto put = [at](auto number) { std::memcpy(at, &number, sizeof number); };
  switch (type) {
    case 5120:
      return put(static_cast<std::int8_t>(value));
    case 5121:
      return put(static_cast<std::uint8_t>(value));
    case 5122:
      return put(static_cast<std::int16_t>(value));
    case 5123:
      return put(static_cast<std::uint16_t>(value));
    case 5125:
      return put(static_cast<std::uint32_t>(value));
    default:
      return put(static_cast<float>(value));
  }
}

}  // namespace

std::size_t add_buffer_view(Document& document, std::span<const std::uint8_t> bytes,
                            std::optional<int> target) {
  const auto [buffer, offset] = append(document, bytes);
  Json view = {{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (target) view["target"] = *target;
  auto& views = document.json["bufferViews"];
  views.push_back(std::move(view));
  return views.size() - 1;
}

void replace_buffer_view(Document& document, std::size_t view, std::span<const std::uint8_t> bytes) {
  const auto old = document.json["bufferViews"][view];
  const auto [buffer, offset] = append(document, bytes);
  auto& entry = document.json["bufferViews"][view];
  entry["buffer"] = buffer;
  entry["byteOffset"] = offset;
  entry["byteLength"] = bytes.size();
  if (old["buffer"].get<std::size_t>() != buffer) return;
  const std::size_t first = index_of(old, "byteOffset").value_or(0);
  erase_unused(document, first, first + old["byteLength"].get<std::size_t>());
}

std::size_t count_view_uses(const Document& document, std::size_t view) {
  std::size_t uses = 0;
  const auto count = [&](const Json& object, auto& self) -> void {
    if (object.is_object() && index_of(object, "bufferView") == view) ++uses;
    if (object.is_structured())
      for (const auto& member : object) self(member, self);
  };
  count(document.json, count);
  return uses;
}

void remove_buffer_view(Document& document, std::size_t view) {
  const Json old = document.json["bufferViews"][view];
  document.json["bufferViews"].erase(view);
  each_view_reference(document.json, [&](Json& reference) {
    const auto index = reference.get<std::size_t>();
    if (index > view) reference = index - 1;
  });
  if (document.json["bufferViews"].empty()) document.json.erase("bufferViews");
  if (!document.chunk_buffer || old["buffer"].get<std::size_t>() != *document.chunk_buffer) return;
  const std::size_t first = index_of(old, "byteOffset").value_or(0);
  erase_unused(document, first, first + old["byteLength"].get<std::size_t>());
}

std::size_t add_accessor(Document& document, Json entry, std::span<const double> values, int components,
                         bool bounds, int target) {
  constexpr int vertices = 34962;
  const auto type = entry["componentType"].get<std::size_t>();
  const auto width = static_cast<std::size_t>(components);
  const std::size_t component = component_bytes(type);
  const std::size_t element = component * width;
  const std::size_t stride = target == vertices ? (element + 3) / 4 * 4 : element;
  const std::size_t count = values.size() / width;
  std::vector<std::uint8_t> bytes(count * stride, 0);
  std::vector<double> lower(width, HUGE_VAL);
  std::vector<double> upper(width, -HUGE_VAL);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < width; ++c) {
      const double value = values[i * width + c];
      store_number(value, type, &bytes[i * stride + c * component]);
      lower[c] = std::min(lower[c], value);
      upper[c] = std::max(upper[c], value);
    }
  for (const char* key : {"sparse", "byteOffset", "min", "max"}) entry.erase(key);
  const std::size_t view = add_buffer_view(document, bytes, target);
  if (stride != element) document.json["bufferViews"][view]["byteStride"] = stride;
  entry["bufferView"] = view;
  entry["count"] = count;
  if (bounds) {
    entry["min"] = lower;
    entry["max"] = upper;
  }
  auto& accessors = document.json["accessors"];
  accessors.push_back(std::move(entry));
  return accessors.size() - 1;
}

void remove_unused_accessors(Document& document, std::vector<std::size_t> accessors) {
  if (!knows_extensions(document.json)) return;
  std::sort(accessors.begin(), accessors.end(), std::greater<>());
  accessors.erase(std::unique(accessors.begin(), accessors.end()), accessors.end());
  std::vector<std::size_t> views;
  for (const std::size_t accessor : accessors) {
    bool used = false;
    each_accessor_reference(document.json,
                            [&](const Json& reference) { used = used || as_index(reference) == accessor; });
    if (used) continue;
    each_view_reference(document.json["accessors"][accessor],
                        [&](const Json& view) { views.push_back(view.get<std::size_t>()); });
    document.json["accessors"].erase(accessor);
    each_accessor_reference(document.json, [&](Json& reference) {
      const auto index = reference.get<std::size_t>();
      if (index > accessor) reference = index - 1;
    });
  }
  std::sort(views.begin(), views.end(), std::greater<>());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  for (const std::size_t view : views)
    if (count_view_uses(document, view) == 0) remove_buffer_view(document, view);
}

}  // namespace applique
