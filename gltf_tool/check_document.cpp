#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "document.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Extensions that change what is read here and are understood, or that do not matter to geometry and base
/// colour. Anything named KHR_materials_… is of the second kind but for specular-glossiness, which has its
/// own base colour.
constexpr std::array<std::string_view, 17> known_extensions = {"KHR_draco_mesh_compression",
                                                               "EXT_meshopt_compression",
                                                               "KHR_meshopt_compression",
                                                               "KHR_mesh_quantization",
                                                               "KHR_texture_transform",
                                                               "EXT_texture_webp",
                                                               "KHR_texture_basisu",
                                                               "MSFT_texture_dds",
                                                               "KHR_lights_punctual",
                                                               "EXT_lights_ies",
                                                               "EXT_lights_image_based",
                                                               "KHR_animation_pointer",
                                                               "KHR_xmp",
                                                               "KHR_xmp_json_ld",
                                                               "MSFT_lod",
                                                               "KHR_node_visibility",
                                                               "FB_ngon_encoding"};

bool is_known(std::string_view extension) {
  if (extension == "KHR_materials_pbrSpecularGlossiness") return false;
  return extension.starts_with("KHR_materials_") ||
         std::find(known_extensions.begin(), known_extensions.end(), extension) != known_extensions.end();
}

/// Walks the document and keeps the first thing that is wrong. Later checks stay safe after a failure, so
/// callers need not stop at each.
class Checker {
 public:
  explicit Checker(const Document& document) : document_(document), root_(document.json) {}

  Result<void> run() {
    check_asset();
    check_extensions();
    for (const char* collection : collections) check_collection(collection);
    if (error_) return tl::unexpected<Error>(*error_);
    each("buffers", [&](const Json& buffer, const std::string& where) {
      size(buffer, "byteLength", where, 1);
      string(buffer, "uri", where);
    });
    each("bufferViews", [&](const Json& view, const std::string& where) { check_buffer_view(view, where); });
    each("accessors",
         [&](const Json& accessor, const std::string& where) { check_accessor(accessor, where); });
    each("images", [&](const Json& image, const std::string& where) {
      string(image, "uri", where);
      reference(image, "bufferView", "bufferViews", where);
    });
    each("textures", [&](const Json& texture, const std::string& where) {
      reference(texture, "source", "images", where);
      reference(texture, "sampler", "samplers", where);
      for (const char* extension : {"EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds"})
        if (const auto* object = find(texture, {"extensions", extension}))
          reference(*object, "source", "images", where);
    });
    each("materials",
         [&](const Json& material, const std::string& where) { check_material(material, where); });
    each("meshes", [&](const Json& mesh, const std::string& where) { check_mesh(mesh, where); });
    each("skins", [&](const Json& skin, const std::string& where) {
      references(skin, "joints", "nodes", where, true);
      reference(skin, "inverseBindMatrices", "accessors", where);
    });
    each("nodes", [&](const Json& node, const std::string& where) {
      reference(node, "mesh", "meshes", where);
      reference(node, "skin", "skins", where);
      references(node, "children", "nodes", where);
      numbers(node, "matrix", 16, where);
      numbers(node, "translation", 3, where);
      numbers(node, "rotation", 4, where);
      numbers(node, "scale", 3, where);
      numbers(node, "weights", 0, where);
    });
    each("scenes",
         [&](const Json& scene, const std::string& where) { references(scene, "nodes", "nodes", where); });
    reference(root_, "scene", "scenes", "the model");
    if (!error_) check_tree();
    if (error_) return tl::unexpected<Error>(*error_);
    return {};
  }

 private:
  static constexpr std::array<const char*, 13> collections = {
      "accessors", "animations", "buffers",  "bufferViews", "cameras", "images",  "materials",
      "meshes",    "nodes",      "samplers", "scenes",      "skins",   "textures"};

  void problem(const std::string& where, const std::string& what, ErrorCode code = ErrorCode::model_invalid) {
    if (!error_) error_ = Error{code, fmt::format("'{}', {}: {}", document_.name, where, what)};
  }

  template <class Function>
  void each(const char* collection, Function check) {
    const auto* items = find(root_, {collection});
    if (items == nullptr || error_) return;
    const std::string kind = singular(collection);
    for (std::size_t i = 0; i < items->size() && !error_; ++i)
      check((*items)[i], fmt::format("{} {}", kind, i));
  }

  static std::string singular(std::string_view collection) {
    if (collection == "bufferViews") return "buffer view";
    if (collection == "meshes") return "mesh";
    return std::string(collection.substr(0, collection.size() - 1));
  }

  void check_asset() {
    const auto* version = find(root_, {"asset", "version"});
    if (version == nullptr || !version->is_string())
      return problem("asset", "it has no version, so this is not a glTF file");
    const auto text = version->get<std::string>();
    if (!text.starts_with("2."))
      problem("asset", fmt::format("glTF version '{}'; only 2.x is read, convert the file to glTF 2.0", text),
              ErrorCode::model_unsupported);
  }

  void check_extensions() {
    const auto* required = find(root_, {"extensionsRequired"});
    if (required == nullptr) return;
    if (!required->is_array()) return problem("extensionsRequired", "it is not an array");
    for (const auto& extension : *required) {
      if (!extension.is_string())
        return problem("extensionsRequired", "it holds something other than strings");
      if (!is_known(extension.get<std::string>()))
        return problem("extensionsRequired",
                       fmt::format("the extension {} is not supported; export the model without it",
                                   extension.get<std::string>()),
                       ErrorCode::model_unsupported);
    }
  }

  void check_collection(const char* collection) {
    const auto* items = find(root_, {collection});
    if (items == nullptr) return;
    if (!items->is_array())
      return problem(collection, fmt::format("it is not an array but {}", items->type_name()));
    for (std::size_t i = 0; i < items->size(); ++i)
      if (!(*items)[i].is_object())
        return problem(fmt::format("{} {}", singular(collection), i), "it is not an object");
  }

  /// A size in bytes or a count: a member that is at least `minimum`; required unless `fallback` is given.
  std::size_t size(const Json& object, const char* key, const std::string& where, std::size_t minimum,
                   std::optional<std::size_t> fallback = {}) {
    const auto* value = find(object, {key});
    if (value == nullptr) {
      if (!fallback) problem(where, fmt::format("{} is missing", key));
      return fallback.value_or(0);
    }
    if (as_index(*value).value_or(0) < minimum || !as_index(*value)) {
      problem(where,
              fmt::format("{} is {}, expected an integer of at least {}", key, shown(*value), minimum));
      return 0;
    }
    return value->get<std::size_t>();
  }

  static std::string shown(const Json& value) {
    const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return text.size() > 40 ? text.substr(0, 40) + "…" : text;
  }

  void string(const Json& object, const char* key, const std::string& where) {
    const auto* value = find(object, {key});
    if (value != nullptr && !value->is_string())
      problem(where, fmt::format("{} is {}, expected a string", key, shown(*value)));
  }

  bool is_index(const Json& value, const char* collection) const {
    const auto index = as_index(value);
    return index && *index < count_of(document_, collection);
  }

  void reference(const Json& object, const char* key, const char* collection, const std::string& where,
                 bool required = false) {
    const auto* value = find(object, {key});
    if (value == nullptr) {
      if (required) problem(where, fmt::format("{} is missing", key));
    } else if (!is_index(*value, collection)) {
      problem(where, fmt::format("{} is {}, but there are {} {}", key, shown(*value),
                                 count_of(document_, collection), collection));
    }
  }

  void references(const Json& object, const char* key, const char* collection, const std::string& where,
                  bool required = false) {
    const auto* values = find(object, {key});
    if (values == nullptr) {
      if (required) problem(where, fmt::format("{} is missing", key));
      return;
    }
    if (!values->is_array()) return problem(where, fmt::format("{} is not an array", key));
    for (const auto& value : *values)
      if (!is_index(value, collection))
        return problem(where, fmt::format("{} holds {}, but there are {} {}", key, shown(value),
                                          count_of(document_, collection), collection));
  }

  /// An optional array of finite numbers; `count` 0 allows any length.
  void numbers(const Json& object, const char* key, std::size_t count, const std::string& where) {
    const auto* values = find(object, {key});
    if (values == nullptr) return;
    if (!values->is_array() || (count != 0 && values->size() != count))
      return problem(where, fmt::format("{} is not an array of {} numbers", key, count));
    for (const auto& value : *values)
      if (!value.is_number() || !(std::abs(value.get<double>()) <= 3.5e38))
        return problem(where, fmt::format("{} holds {}, expected a finite number", key, shown(value)));
  }

  void check_range(const Json& view, const std::string& where) {
    reference(view, "buffer", "buffers", where, true);
    const std::size_t offset = size(view, "byteOffset", where, 0, 0);
    const std::size_t length = size(view, "byteLength", where, 1);
    if (error_) return;
    const std::size_t buffer = view["buffer"].get<std::size_t>();
    const std::size_t available = root_["buffers"][buffer]["byteLength"].get<std::size_t>();
    if (offset > available || length > available - offset)
      problem(where, fmt::format("bytes {} to {} lie beyond the {} bytes of buffer {}", offset,
                                 offset + length, available, buffer));
  }

  void check_buffer_view(const Json& view, const std::string& where) {
    check_range(view, where);
    const std::size_t stride = size(view, "byteStride", where, 1, 4);
    if (stride > 252) problem(where, fmt::format("byteStride is {}, at most 252 is allowed", stride));
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      const auto* compressed = find(view, {"extensions", extension});
      if (compressed == nullptr) continue;
      const std::string inner = fmt::format("{}, {}", where, extension);
      check_range(*compressed, inner);
      size(*compressed, "count", inner, 1);
      size(*compressed, "byteStride", inner, 1);
      string(*compressed, "mode", inner);
      string(*compressed, "filter", inner);
    }
  }

  void check_accessor(const Json& accessor, const std::string& where) {
    static constexpr std::array<std::string_view, 7> types = {"SCALAR", "VEC2", "VEC3", "VEC4",
                                                              "MAT2",   "MAT3", "MAT4"};
    static constexpr std::array<std::size_t, 6> component_types = {5120, 5121, 5122, 5123, 5125, 5126};
    reference(accessor, "bufferView", "bufferViews", where);
    size(accessor, "byteOffset", where, 0, 0);
    size(accessor, "count", where, 1);
    const std::size_t component = size(accessor, "componentType", where, 0);
    if (std::find(component_types.begin(), component_types.end(), component) == component_types.end())
      problem(where, fmt::format("componentType {} is not a glTF type", component));
    const auto* type = find(accessor, {"type"});
    if (type == nullptr || !type->is_string() ||
        std::find(types.begin(), types.end(), type->get<std::string>()) == types.end())
      problem(where, "type is missing or not a glTF type");
    if (const auto* normalized = find(accessor, {"normalized"});
        normalized != nullptr && !normalized->is_boolean())
      problem(where, "normalized is not true or false");
    if (const auto* sparse = find(accessor, {"sparse"})) {
      const std::string inner = where + ", sparse";
      if (size(*sparse, "count", inner, 1) > size(accessor, "count", where, 1))
        problem(inner, "count is larger than the accessor's");
      for (const char* key : {"indices", "values"}) {
        const auto* part = find(*sparse, {key});
        if (part == nullptr) return problem(inner, fmt::format("{} is missing", key));
        reference(*part, "bufferView", "bufferViews", inner, true);
        size(*part, "byteOffset", inner, 0, 0);
      }
      const std::size_t indices = size(sparse->at("indices"), "componentType", inner, 0);
      if (indices != 5121 && indices != 5123 && indices != 5125)
        problem(inner, fmt::format("indices have componentType {}, expected 5121, 5123 or 5125", indices));
    }
  }

  void check_material(const Json& material, const std::string& where) {
    numbers(material, "emissiveFactor", 3, where);
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"})
      if (const auto* texture = find(material, {key}))
        reference(*texture, "index", "textures", where + ", " + key, true);
    const auto* pbr = find(material, {"pbrMetallicRoughness"});
    if (pbr == nullptr) return;
    numbers(*pbr, "baseColorFactor", 4, where);
    for (const char* key : {"metallicFactor", "roughnessFactor"})
      if (const auto* factor = find(*pbr, {key}); factor != nullptr && !factor->is_number())
        problem(where, fmt::format("{} is {}, expected a number", key, shown(*factor)));
    for (const char* key : {"baseColorTexture", "metallicRoughnessTexture"})
      if (const auto* texture = find(*pbr, {key}))
        reference(*texture, "index", "textures", where + ", " + key, true);
  }

  void check_attributes(const Json* attributes, const std::string& where) {
    if (attributes == nullptr || !attributes->is_object())
      return problem(where, "attributes are not an object");
    for (const auto& item : attributes->items())
      reference(*attributes, item.key().c_str(), "accessors", where);
  }

  void check_mesh(const Json& mesh, const std::string& where) {
    numbers(mesh, "weights", 0, where);
    const auto* primitives = find(mesh, {"primitives"});
    if (primitives == nullptr || !primitives->is_array())
      return problem(where, "primitives are not an array");
    for (std::size_t i = 0; i < primitives->size() && !error_; ++i) {
      const auto& primitive = (*primitives)[i];
      const std::string inner = fmt::format("{}, primitive {}", where, i);
      check_attributes(find(primitive, {"attributes"}), inner);
      reference(primitive, "indices", "accessors", inner);
      reference(primitive, "material", "materials", inner);
      if (size(primitive, "mode", inner, 0, 4) > 6) problem(inner, "mode is not one of 0 to 6");
      if (const auto* targets = find(primitive, {"targets"})) {
        if (!targets->is_array()) return problem(inner, "targets are not an array");
        for (const auto& target : *targets) check_attributes(&target, inner + ", morph target");
      }
      if (const auto* draco = find(primitive, {"extensions", "KHR_draco_mesh_compression"})) {
        reference(*draco, "bufferView", "bufferViews", inner + ", KHR_draco_mesh_compression", true);
        const auto* attributes = find(*draco, {"attributes"});
        if (attributes == nullptr || !attributes->is_object())
          problem(inner + ", KHR_draco_mesh_compression", "attributes are not an object");
      }
    }
  }

  /// Every node has at most one parent and no node is its own ancestor.
  void check_tree() {
    const std::size_t count = count_of(document_, "nodes");
    std::vector<std::size_t> parent(count, count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto* children = find(root_["nodes"][i], {"children"});
      if (children == nullptr) continue;
      for (const auto& child : *children) {
        auto& slot = parent[child.get<std::size_t>()];
        if (slot != count)
          return problem(fmt::format("node {}", child.get<std::size_t>()),
                         fmt::format("it is a child of node {} and of node {}", slot, i));
        slot = i;
      }
    }
    // 0 unseen, 1 on the way up, 2 known to end at a root.
    std::vector<std::uint8_t> state(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t at = i;
      while (at != count && state[at] == 0) {
        state[at] = 1;
        at = parent[at];
      }
      if (at != count && state[at] == 1)
        return problem(fmt::format("node {}", at), "it is its own ancestor (a node cycle)");
      for (at = i; at != count && state[at] == 1; at = parent[at]) state[at] = 2;
    }
  }

  const Document& document_;
  const Json& root_;
  std::optional<Error> error_;
};

}  // namespace

Result<void> check_document(const Document& document) {
  return Checker(document).run();
}

}  // namespace applique
