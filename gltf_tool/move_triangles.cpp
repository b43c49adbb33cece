#include "move_triangles.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "binary_edit.h"
#include "edit.h"
#include "geometry.h"

namespace applique {
namespace {

using Json = Document::Json;

constexpr int vertex_target = 34962;
constexpr int index_target = 34963;
constexpr int float_type = 5126;

/// The vertices of a new primitive: the old one under each, and where it is in the new coordinates.
struct Corners {
  std::vector<std::uint32_t> sources;
  std::vector<double> uvs;       ///< 2 each.
  std::vector<double> tangents;  ///< 4 each; empty: none.
  std::vector<double> indices;
};

Corners gather_corners(const ModelPart& part, const MovedTriangles& moved) {
  Corners corners;
  std::map<std::tuple<std::uint32_t, std::array<float, 2>, std::array<float, 4>>, std::size_t> known;
  for (std::size_t i = 0; i < moved.triangles.size(); ++i) {
    const auto& triangle = part.triangles[moved.triangles[i]];
    // The decoder exchanged two corners where the node mirrors: back to the file's order.
    for (const std::size_t k :
         part.mirrored ? std::array<std::size_t, 3>{0, 2, 1} : std::array<std::size_t, 3>{0, 1, 2}) {
      const auto& uv = moved.uvs[i][k];
      const auto tangent = moved.tangents.empty() ? std::array<float, 4>{} : moved.tangents[i][k];
      const auto [place, fresh] = known.try_emplace({triangle[k], uv, tangent}, known.size());
      corners.indices.push_back(static_cast<double>(place->second));
      if (!fresh) continue;
      corners.sources.push_back(triangle[k]);
      corners.uvs.insert(corners.uvs.end(), uv.begin(), uv.end());
      if (!moved.tangents.empty())
        corners.tangents.insert(corners.tangents.end(), tangent.begin(), tangent.end());
    }
  }
  return corners;
}

class Mover {
 public:
  Mover(Document& document, const Model& model, const tinygltf::Model& geometry, const MovedTriangles& moved)
      : document_(document),
        model_(model),
        part_(model.parts[moved.part]),
        entry_(geometry.meshes[part_.mesh].primitives[part_.primitive]),
        geometry_(geometry),
        moved_(moved),
        mesh_(document.json["nodes"][part_.node]["mesh"].get<std::size_t>()) {}

  Result<std::size_t> run() {
    const Json old = primitives()[part_.primitive];
    APPLIQUE_TRY(Json added, new_primitive(old));
    const std::vector<double> rest = rest_indices();
    if (rest.empty()) {
      primitives()[part_.primitive] = std::move(added);
      return part_.primitive;
    }
    APPLIQUE_TRY(Json kept, kept_primitive(old, rest));
    primitives()[part_.primitive] = std::move(kept);
    primitives().push_back(std::move(added));
    return primitives().size() - 1;
  }

 private:
  Json& primitives() { return document_.json["meshes"][mesh_]["primitives"]; }

  Result<Json> new_primitive(const Json& old) {
    const Corners corners = gather_corners(part_, moved_);
    Json primitive = old;
    strip(primitive);
    Json attributes = Json::object();
    for (const auto& item : old["attributes"].items()) {
      const std::string& name = item.key();
      if (moved_.uv_set == 0 && name.starts_with("TEXCOORD_")) continue;
      if (name == "TANGENT" && !corners.tangents.empty()) continue;
      APPLIQUE_TRY(attributes[name], copy_attribute(item.value().get<std::size_t>(),
                                                    entry_.attributes.at(name), name, &corners.sources));
    }
    const std::size_t uvs = add_floats(corners.uvs, "VEC2", 2);
    // Sets count up from 0 without a gap.
    for (std::size_t set = 0; set <= moved_.uv_set; ++set)
      if (const std::string name = fmt::format("TEXCOORD_{}", set);
          set == moved_.uv_set || !attributes.contains(name))
        attributes[name] = uvs;
    if (!corners.tangents.empty()) attributes["TANGENT"] = add_floats(corners.tangents, "VEC4", 4);
    APPLIQUE_CHECK(copy_targets(primitive, &corners.sources));
    primitive["attributes"] = std::move(attributes);
    primitive["indices"] = add_indices(corners.indices, corners.sources.size());
    primitive["material"] = moved_.material;
    restore_variants(primitive);
    if (part_.material) lead_variants(primitive, *part_.material, moved_.material);
    return primitive;
  }

  Result<Json> kept_primitive(const Json& old, const std::vector<double>& rest) {
    Json primitive = old;
    if (find(old, {"extensions", "KHR_draco_mesh_compression"}) != nullptr) {
      for (auto& item : primitive["attributes"].items()) {
        const auto accessor = item.value().get<std::size_t>();
        APPLIQUE_TRY(item.value(),
                     copy_attribute(accessor, entry_.attributes.at(item.key()), item.key(), nullptr));
      }
    }
    strip(primitive);
    primitive["indices"] = add_indices(rest, part_.positions.size());
    primitive.erase("material");
    if (moved_.rest_material) primitive["material"] = *moved_.rest_material;
    restore_variants(primitive);
    return primitive;
  }

  /// Those of the model before any change.
  void restore_variants(Json& primitive) const {
    constexpr const char* variants = "KHR_materials_variants";
    const auto& before = model_.document.json["meshes"][part_.mesh]["primitives"][part_.primitive];
    if (const auto* old = find(before, {"extensions", variants})) primitive["extensions"][variants] = *old;
  }

  /// What a list of triangles with indices and without compression does not have.
  static void strip(Json& primitive) {
    primitive.erase("mode");
    if (!primitive.contains("extensions")) return;
    primitive["extensions"].erase("KHR_draco_mesh_compression");
    if (primitive["extensions"].empty()) primitive.erase("extensions");
  }

  Result<void> copy_targets(Json& primitive, const std::vector<std::uint32_t>* sources) {
    if (!primitive.contains("targets")) return {};
    auto& targets = primitive["targets"];
    for (std::size_t t = 0; t < targets.size(); ++t)
      for (auto& item : targets[t].items()) {
        const auto accessor = item.value().get<std::size_t>();
        APPLIQUE_TRY(item.value(),
                     copy_attribute(accessor, entry_.targets[t].at(item.key()),
                                    fmt::format("morph target {}, {}", t, item.key()), sources));
      }
    return {};
  }

  /// An accessor with the attribute of the new vertices; of all the old ones where `sources` is null.
  Result<std::size_t> copy_attribute(std::size_t accessor, int decoded, const std::string& name,
                                     const std::vector<std::uint32_t>* sources) {
    const std::string where =
        fmt::format("'{}', mesh {}, primitive {}, {}", document_.name, part_.mesh, part_.primitive, name);
    int components = 0;
    APPLIQUE_TRY(auto values, read_stored(geometry_, decoded, components, where));
    const auto width = static_cast<std::size_t>(components);
    if (sources != nullptr) {
      std::vector<double> picked;
      picked.reserve(sources->size() * width);
      for (const std::uint32_t source : *sources) {
        if ((source + 1) * width > values.size())
          return fail(ErrorCode::model_invalid, fmt::format("{}: {} elements for {} vertices", where,
                                                            values.size() / width, part_.positions.size()));
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(source * width);
        picked.insert(picked.end(), first, first + components);
      }
      values = std::move(picked);
    }
    return add_accessor(document_, document_.json["accessors"][accessor], values, components,
                        name.ends_with("POSITION"), vertex_target);
  }

  std::size_t add_floats(const std::vector<double>& values, const char* type, int components) {
    return add_accessor(document_, {{"componentType", float_type}, {"type", type}}, values, components, false,
                        vertex_target);
  }

  std::size_t add_indices(const std::vector<double>& indices, std::size_t vertices) {
    constexpr std::size_t narrow = 65535;  // which would itself be the primitive restart value
    return add_accessor(document_, {{"componentType", vertices <= narrow ? 5123 : 5125}, {"type", "SCALAR"}},
                        indices, 1, false, index_target);
  }

  [[nodiscard]] std::vector<double> rest_indices() const {
    std::vector<char> taken(part_.triangles.size(), 0);
    for (const std::uint32_t t : moved_.triangles) taken[t] = 1;
    std::vector<double> rest;
    for (std::size_t t = 0; t < taken.size(); ++t) {
      if (taken[t] != 0) continue;
      const auto& corners = part_.triangles[t];
      rest.push_back(corners[0]);
      rest.push_back(corners[part_.mirrored ? 2 : 1]);
      rest.push_back(corners[part_.mirrored ? 1 : 2]);
    }
    return rest;
  }

  Document& document_;
  const Model& model_;
  const ModelPart& part_;
  const tinygltf::Primitive& entry_;
  const tinygltf::Model& geometry_;
  const MovedTriangles& moved_;
  std::size_t mesh_;
};

}  // namespace

Result<std::size_t> move_triangles(Document& document, const Model& model, const tinygltf::Model& geometry,
                                   const MovedTriangles& moved) {
  return Mover(document, model, geometry, moved).run();
}

std::vector<std::size_t> accessors_of(const Json& primitive) {
  std::vector<std::size_t> accessors;
  const auto add = [&](const Json& attributes) {
    for (const auto& attribute : attributes)
      if (const auto index = as_index(attribute)) accessors.push_back(*index);
  };
  add(primitive["attributes"]);
  if (const auto indices = index_of(primitive, "indices")) accessors.push_back(*indices);
  if (const auto* targets = find(primitive, {"targets"}))
    for (const auto& target : *targets) add(target);
  return accessors;
}

}  // namespace applique
