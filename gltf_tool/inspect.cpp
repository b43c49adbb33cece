#include "inspect.h"

#include <algorithm>
#include <cmath>

#include "uv_coverage.h"

namespace applique {
namespace {

using Json = nlohmann::ordered_json;

constexpr int coverage_size = 512;

std::string name_in(const Document& document, const char* collection, std::size_t index) {
  const auto* name = find(document.json[collection][index], {"name"});
  return name != nullptr && name->is_string() ? name->get<std::string>() : "";
}

std::vector<std::string> strings_of(const Document& document, const char* key) {
  std::vector<std::string> strings;
  const auto* values = find(document.json, {key});
  if (values == nullptr || !values->is_array()) return strings;
  for (const auto& value : *values)
    if (value.is_string()) strings.push_back(value.get<std::string>());
  return strings;
}

const Document::Json& primitive_of(const Model& model, const ModelPart& part) {
  return model.document.json["meshes"][part.mesh]["primitives"][part.primitive];
}

std::vector<std::string> uv_sets_of(const Model& model, const ModelPart& part) {
  std::vector<std::string> sets;
  for (const auto& item : primitive_of(model, part)["attributes"].items())
    if (item.key().starts_with("TEXCOORD_")) sets.push_back(item.key());
  return sets;
}

void read_texture(const Model& model, MaterialSummary& summary) {
  if (!summary.material) return;
  const ModelMaterial& material = model.materials[*summary.material];
  if (!material.texture) return;
  if (!material.image) {
    summary.texture_problem = "its texture has no image";
    return;
  }
  const auto image = load_model_image(model, *material.image);
  if (image) {
    summary.texture_size = {image->width, image->height};
  } else {
    summary.texture_problem = image.error().message;
  }
}

/// Sums over the triangles of one material.
MaterialSummary summarise_material(const Model& model, std::optional<std::size_t> material) {
  MaterialSummary summary;
  summary.material = material;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  if (material) {
    summary.name = model.materials[*material].name;
    wrap_u = model.materials[*material].wrap_u;
    wrap_v = model.materials[*material].wrap_v;
  }
  read_texture(model, summary);
  UvCoverage coverage(coverage_size, wrap_u, wrap_v);
  double area = 0;
  double uv_area = 0;
  std::size_t turned = 0;
  std::size_t with_area = 0;
  bool first = true;
  for (const ModelPart& part : model.parts) {
    if (part.material != material) continue;
    const auto sets = uv_sets_of(model, part);
    if (summary.triangles == 0) summary.uv_sets = sets;
    std::erase_if(summary.uv_sets,
                  [&](const auto& set) { return std::find(sets.begin(), sets.end(), set) == sets.end(); });
    summary.triangles += part.triangles.size();
    if (part.uvs.empty()) {
      summary.triangles_without_uvs += part.triangles.size();
      continue;
    }
    for (const auto& t : part.triangles) {
      const std::array<std::array<double, 2>, 3> uvs = {part.uvs[t[0]], part.uvs[t[1]], part.uvs[t[2]]};
      for (const auto& uv : uvs)
        for (std::size_t k = 0; k < 2; ++k) {
          summary.uv_lower[k] = first ? uv[k] : std::min(summary.uv_lower[k], uv[k]);
          summary.uv_upper[k] = first ? uv[k] : std::max(summary.uv_upper[k], uv[k]);
        }
      first = false;
      coverage.add(uvs);
      const double signed_area = 0.5 * ((uvs[1][0] - uvs[0][0]) * (uvs[2][1] - uvs[0][1]) -
                                        (uvs[1][1] - uvs[0][1]) * (uvs[2][0] - uvs[0][0]));
      const Vec3 edge = part.positions[t[1]] - part.positions[t[0]];
      area += 0.5 * edge.cross(part.positions[t[2]] - part.positions[t[0]]).norm();
      uv_area += std::abs(signed_area);
      turned += signed_area < 0 ? 1 : 0;
      with_area += signed_area != 0 ? 1 : 0;
      summary.collapsed_triangles += signed_area == 0 ? 1 : 0;
    }
  }
  summary.covered_texels = coverage.covered();
  summary.shared_texels = coverage.shared();
  if (with_area != 0)
    summary.mirrored =
        static_cast<double>(std::min(turned, with_area - turned)) / static_cast<double>(with_area);
  if (summary.texture_size && area > 0)
    summary.texel_density =
        std::sqrt(uv_area * (*summary.texture_size)[0] * (*summary.texture_size)[1] / area);
  return summary;
}

std::size_t count_components(const SurfaceMesh& mesh) {
  std::vector<char> seen(mesh.faces.size(), 0);
  std::vector<FaceId> stack;
  std::size_t components = 0;
  for (const FaceId start : ids<FaceId>(mesh.faces.size())) {
    if (seen[start.value] != 0) continue;
    ++components;
    seen[start.value] = 1;
    stack.push_back(start);
    while (!stack.empty()) {
      const FaceId f = stack.back();
      stack.pop_back();
      for (const FaceId g : mesh.neighbours[f])
        if (g.valid() && seen[g.value] == 0) {
          seen[g.value] = 1;
          stack.push_back(g);
        }
    }
  }
  return components;
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json to_json(const MaterialSummary& m) {
  Json json;
  json["material"] = or_null(m.material);
  json["name"] = m.name;
  json["triangles"] = m.triangles;
  json["triangles_without_uvs"] = m.triangles_without_uvs;
  json["uv_sets"] = m.uv_sets;
  json["texture_size"] = or_null(m.texture_size);
  if (!m.texture_problem.empty()) json["texture_problem"] = m.texture_problem;
  json["uv_lower"] = m.uv_lower;
  json["uv_upper"] = m.uv_upper;
  json["covered_texels"] = m.covered_texels;
  json["shared_texels"] = m.shared_texels;
  json["mirrored"] = m.mirrored;
  json["collapsed_triangles"] = m.collapsed_triangles;
  json["texel_density"] = m.texel_density;
  return json;
}

Json to_json(const PartSummary& p) {
  Json json;
  json["node"] = p.node;
  json["node_name"] = p.node_name;
  json["mesh"] = p.mesh;
  json["mesh_name"] = p.mesh_name;
  json["primitive"] = p.primitive;
  json["material"] = or_null(p.material);
  json["vertices"] = p.vertices;
  json["triangles"] = p.triangles;
  return json;
}

}  // namespace

ModelSummary inspect_model(const Model& model) {
  const Document& document = model.document;
  ModelSummary summary;
  summary.nodes = count_of(document, "nodes");
  summary.meshes = count_of(document, "meshes");
  summary.scenes = count_of(document, "scenes");
  summary.skins = count_of(document, "skins");
  summary.animations = count_of(document, "animations");
  summary.cameras = count_of(document, "cameras");
  summary.lower = model.lower;
  summary.upper = model.upper;
  summary.extensions_used = strings_of(document, "extensionsUsed");
  summary.extensions_required = strings_of(document, "extensionsRequired");
  summary.warnings = model.warnings;
  std::vector<std::optional<std::size_t>> materials;
  for (const ModelPart& part : model.parts) {
    summary.parts.push_back({part.node, part.mesh, part.primitive, part.material,
                             name_in(document, "nodes", part.node), name_in(document, "meshes", part.mesh),
                             part.positions.size(), part.triangles.size()});
    summary.triangles += part.triangles.size();
    if (const auto* targets = find(primitive_of(model, part), {"targets"}))
      summary.morph_targets = std::max(summary.morph_targets, targets->size());
    if (std::find(materials.begin(), materials.end(), part.material) == materials.end())
      materials.push_back(part.material);
  }
  for (const auto& material : materials) summary.materials.push_back(summarise_material(model, material));

  const SurfaceMesh mesh = build_surface(model).mesh;
  summary.surface_vertices = mesh.positions.size();
  summary.components = count_components(mesh);
  for (const auto& neighbours : mesh.neighbours)
    summary.boundary_edges += static_cast<std::size_t>(
        std::count_if(neighbours.begin(), neighbours.end(), [](FaceId f) { return !f.valid(); }));
  summary.non_manifold_edges = mesh.cut_edges;
  summary.split_vertices = mesh.split_vertices;
  summary.degenerate_triangles = mesh.dropped_triangles;
  return summary;
}

Json to_json(const ModelSummary& s) {
  Json json;
  json["nodes"] = s.nodes;
  json["meshes"] = s.meshes;
  json["scenes"] = s.scenes;
  json["skins"] = s.skins;
  json["animations"] = s.animations;
  json["cameras"] = s.cameras;
  json["morph_targets"] = s.morph_targets;
  json["triangles"] = s.triangles;
  json["lower"] = {s.lower.x(), s.lower.y(), s.lower.z()};
  json["upper"] = {s.upper.x(), s.upper.y(), s.upper.z()};
  json["surface"] = {{"vertices", s.surface_vertices},     {"components", s.components},
                     {"boundary_edges", s.boundary_edges}, {"non_manifold_edges", s.non_manifold_edges},
                     {"split_vertices", s.split_vertices}, {"degenerate_triangles", s.degenerate_triangles}};
  json["parts"] = Json::array();
  for (const auto& part : s.parts) json["parts"].push_back(to_json(part));
  json["materials"] = Json::array();
  for (const auto& material : s.materials) json["materials"].push_back(to_json(material));
  json["extensions_used"] = s.extensions_used;
  json["extensions_required"] = s.extensions_required;
  json["warnings"] = Json::array();
  for (const auto& warning : s.warnings)
    json["warnings"].push_back({{"code", warning.code}, {"message", warning.message}});
  return json;
}

}  // namespace applique
