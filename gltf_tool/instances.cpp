#include "instances.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace applique {
namespace {

using Primitive = std::pair<std::size_t, std::size_t>;  // mesh, primitive

Primitive primitive_of(const ModelPart& part) {
  return {part.mesh, part.primitive};
}

/// Calls `visit(source)` for each triangle of the model that shows some of the image.
template <class Visit>
void for_textured_sources(const SolvedDecal& decal, const Visit& visit) {
  for (const PatchFaceId f : ids<PatchFaceId>(decal.map.patch.faces.size())) {
    const FaceId face = decal.map.patch.faces[f].mesh_face;
    if (decal.map.textured[f] != 0 && face.valid()) visit(decal.surface->source(face));
  }
}

/// What lies where: the decals of one node by part, those of all nodes by primitive.
struct Layers {
  std::map<std::uint32_t, std::set<std::size_t>> own;
  std::map<Primitive, std::set<std::size_t>> common;
  std::set<std::size_t> own_nodes;  ///< Nodes with decals of their own: their mesh differs from the others'.
};

Layers layers_of(const SolvedJob& job) {
  Layers layers;
  for (std::size_t d = 0; d < job.decals.size(); ++d) {
    if (job.decals[d].job.output != DecalOutput::bake) continue;
    const auto add = [&](std::uint32_t index) {
      const ModelPart& part = job.model.parts[index];
      if (job.decals[d].job.instance == Instance::all) {
        layers.common[primitive_of(part)].insert(d);
      } else {
        layers.own[index].insert(d);
        layers.own_nodes.insert(part.node);
      }
    };
    for_textured_sources(job.decals[d], [&](const ModelSurface::Source& source) {
      add(source.part);
      if (const auto former = former_part(job, job.decals[d].job, source.part)) add(*former);
    });
  }
  return layers;
}

/// Whether a node without decals of its own shows the mesh, in whatever scene.
bool is_shown_elsewhere(const SolvedJob& job, const std::set<std::size_t>& own_nodes, std::size_t mesh) {
  const auto& nodes = job.model.document.json.at("nodes");
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (index_of(nodes[n], "mesh") == mesh && !own_nodes.contains(n)) return true;
  return false;
}

}  // namespace

std::vector<TouchedPart> find_touched_parts(const SolvedJob& job) {
  const Layers layers = layers_of(job);
  std::vector<TouchedPart> touched;
  std::map<Primitive, std::uint32_t> others;  // of the nodes without decals of their own, some part
  for (std::uint32_t p = 0; p < job.model.parts.size(); ++p) {
    const ModelPart& part = job.model.parts[p];
    const auto common = layers.common.find(primitive_of(part));
    if (!layers.own_nodes.contains(part.node)) {
      if (common != layers.common.end()) others[primitive_of(part)] = p;
      continue;
    }
    TouchedPart own;
    own.part = p;
    if (const auto decals = layers.own.find(p); decals != layers.own.end()) own.decals = decals->second;
    if (common != layers.common.end()) {
      own.decals.insert(common->second.begin(), common->second.end());
      others.try_emplace(common->first, p);
    }
    if (!own.decals.empty()) touched.push_back(std::move(own));
  }
  for (const auto& [primitive, part] : others)
    if (is_shown_elsewhere(job, layers.own_nodes, primitive.first))
      touched.push_back({part, true, layers.common.at(primitive)});
  return touched;
}

std::optional<std::uint32_t> former_part(const SolvedJob& job, const DecalJob& decal, std::uint32_t part) {
  const auto former = job.former.find(part);
  if (former == job.former.end() || decal.uv_conflict != UvConflict::share) return std::nullopt;
  return former->second.part;
}

std::optional<std::uint32_t> part_that_shows(const Model& model, const DecalJob& decal,
                                             const std::vector<std::uint32_t>& parts, std::uint32_t source) {
  const auto shown = std::find_if(parts.begin(), parts.end(), [&](std::uint32_t part) {
    return part == source || (decal.instance == Instance::all &&
                              primitive_of(model.parts[part]) == primitive_of(model.parts[source]));
  });
  return shown == parts.end() ? std::nullopt : std::optional(*shown);
}

std::uint32_t part_that_stands_for(const Model& model, const DecalJob& decal, std::uint32_t part) {
  if (decal.instance != Instance::all) return part;
  const auto first = std::find_if(model.parts.begin(), model.parts.end(), [&](const ModelPart& other) {
    return primitive_of(other) == primitive_of(model.parts[part]);
  });
  return static_cast<std::uint32_t>(first - model.parts.begin());
}

std::set<std::optional<std::size_t>> materials_under(const SolvedDecal& decal, const Model& model) {
  std::set<std::optional<std::size_t>> materials;
  for_textured_sources(decal, [&](const ModelSurface::Source& source) {
    materials.insert(model.parts[source.part].material);
  });
  return materials;
}

std::vector<std::string> variants_without(const SolvedDecal& decal, const Model& model) {
  std::set<Primitive> primitives;
  for_textured_sources(decal, [&](const ModelSurface::Source& source) {
    primitives.insert(primitive_of(model.parts[source.part]));
  });
  std::set<std::size_t> variants;
  for (const auto& [mesh, index] : primitives) {
    const auto& primitive = model.document.json["meshes"][mesh]["primitives"][index];
    const auto* mappings = find(primitive, {"extensions", "KHR_materials_variants", "mappings"});
    if (mappings == nullptr || !mappings->is_array()) continue;
    for (const auto& mapping : *mappings) {
      const auto* list = find(mapping, {"variants"});
      if (list == nullptr || !list->is_array() ||
          index_of(mapping, "material") == index_of(primitive, "material"))
        continue;
      for (const auto& variant : *list)
        if (const auto v = as_index(variant)) variants.insert(*v);
    }
  }
  std::vector<std::string> names;
  const auto* list = find(model.document.json, {"extensions", "KHR_materials_variants", "variants"});
  for (const std::size_t v : variants) {
    const bool named = list != nullptr && list->is_array() && v < list->size() &&
                       (*list)[v].contains("name") && (*list)[v]["name"].is_string();
    names.push_back(named ? fmt::format("'{}'", (*list)[v]["name"].get<std::string>())
                          : fmt::format("{}", v));
  }
  return names;
}

bool lies_on_skin(const SolvedDecal& decal, const Model& model) {
  std::set<std::uint32_t> parts;
  for_textured_sources(decal, [&](const ModelSurface::Source& source) { parts.insert(source.part); });
  return std::any_of(parts.begin(), parts.end(), [&](std::uint32_t part) {
    return model.document.json.at("nodes").at(model.parts[part].node).contains("skin");
  });
}

bool has_vertex_colours(const SolvedDecal& decal, const Model& model) {
  bool found = false;
  for_textured_sources(decal, [&](const ModelSurface::Source& source) {
    const ModelPart& part = model.parts[source.part];
    if (part.tinted.empty()) return;
    for (const std::uint32_t corner : part.triangles[source.triangle])
      found = found || part.tinted[corner] != 0;
  });
  return found;
}

}  // namespace applique
