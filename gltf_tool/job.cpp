#include "job.h"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "document.h"
#include "schema.h"

namespace applique {
namespace {

using nlohmann::json;

// Everything below reads JSON that the schema has passed.

Pixel pixel_of(const json& value) {
  return {value[0].get<double>(), value[1].get<double>()};
}

Vec3 vector_of(const json& value) {
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

Reference reference_of(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.get<std::size_t>();
}

std::vector<Reference> references_of(const json& decal, const char* key) {
  std::vector<Reference> references;
  for (const json& value : decal.value(key, json::array())) references.push_back(reference_of(value));
  return references;
}

RegionChoice region_of(const json& decal) {
  const auto region = decal.find("region");
  if (region == decal.end()) return AutomaticRegion{};
  if (region->contains("alpha")) return AlphaRegion{region->at("alpha").get<double>()};
  if (region->contains("rectangle")) return RectangleRegion{};
  ContourRegion contour;
  for (const json& corner : region->at("contour")) contour.contour.push_back(pixel_of(corner));
  return contour;
}

Place place_of(const json& feature) {
  const Reference mesh = feature.contains("mesh") ? reference_of(feature["mesh"]) : Reference(std::size_t{0});
  const auto primitive = feature.value("primitive", std::size_t{0});
  if (feature.contains("position")) {
    PositionPlace place;
    place.position = vector_of(feature["position"]);
    if (feature.contains("max_distance")) place.max_distance = feature["max_distance"].get<double>();
    return place;
  }
  if (feature.contains("uv"))
    return UvPlace{{feature["uv"][0].get<double>(), feature["uv"][1].get<double>()},
                   reference_of(feature["material"])};
  if (feature.contains("vertex")) return VertexPlace{feature["vertex"].get<std::size_t>(), mesh, primitive};
  if (feature.contains("triangle"))
    return TrianglePlace{feature["triangle"].get<std::size_t>(),
                         feature["barycentric"].get<std::array<double, 3>>(), mesh, primitive};
  return RayPlace{vector_of(feature["ray"]["origin"]), vector_of(feature["ray"]["direction"])};
}

constexpr std::array blend_names = {"normal",     "multiply",    "screen",     "overlay",    "darken",
                                    "lighten",    "color-dodge", "color-burn", "hard-light", "soft-light",
                                    "difference", "exclusion",   "hue",        "saturation", "color",
                                    "luminosity", "add",         "erase"};

BlendMode blend_of(const std::string& name) {
  return static_cast<BlendMode>(std::find(blend_names.begin(), blend_names.end(), name) -
                                blend_names.begin());
}

/// What the keys of "layers" write.
struct LayerKind {
  const char* key;
  MaterialSlot slot;
  std::array<bool, 4> channels;
  bool scalar;
};
constexpr std::array layer_kinds = {
    LayerKind{"baseColor", MaterialSlot::base_color, {true, true, true, true}, false},
    LayerKind{"normal", MaterialSlot::normal, {true, true, true, false}, false},
    LayerKind{"metallicRoughness", MaterialSlot::metallic_roughness, {false, true, true, false}, false},
    LayerKind{"roughness", MaterialSlot::metallic_roughness, {false, true, false, false}, true},
    LayerKind{"metallic", MaterialSlot::metallic_roughness, {false, false, true, false}, true},
    LayerKind{"occlusion", MaterialSlot::occlusion, {true, false, false, false}, true},
    LayerKind{"emissive", MaterialSlot::emissive, {true, true, true, false}, false}};

void read_layer_source(const json& source, const std::filesystem::path& folder, DecalLayer& layer) {
  if (source.is_string()) layer.image = folder / source.get<std::string>();
  if (source.is_number()) layer.value.emplace().fill(source.get<double>());
  if (source.is_array()) layer.value = source.get<std::array<double, 3>>();
}

DecalLayer layer_of(const json& value, const LayerKind& kind, const std::filesystem::path& folder) {
  DecalLayer layer;
  layer.name = kind.key;
  layer.slot = kind.slot;
  layer.channels = kind.channels;
  layer.scalar = kind.scalar;
  if (!value.is_object()) {
    read_layer_source(value, folder, layer);
    return layer;
  }
  for (const char* source : {"image", "value"})
    if (value.contains(source)) read_layer_source(value[source], folder, layer);
  layer.opacity = value.value("opacity", layer.opacity);
  layer.blend = blend_of(value.value("blend", "normal"));
  return layer;
}

/// The base colour comes from the decal's own image and blend, unless "layers" says otherwise.
std::vector<DecalLayer> layers_of(const json& decal, const std::filesystem::path& folder) {
  const json layers = decal.value("layers", json::object());
  std::vector<DecalLayer> list;
  if (!layers.contains("baseColor")) list.emplace_back();
  for (const LayerKind& kind : layer_kinds)
    if (layers.contains(kind.key) && layers[kind.key] != false)
      list.push_back(layer_of(layers[kind.key], kind, folder));
  const json own = layers.value("baseColor", json());
  if (decal.contains("blend") && !(own.is_object() && own.contains("blend")))
    for (DecalLayer& layer : list)
      if (layer.slot == MaterialSlot::base_color) layer.blend = blend_of(decal["blend"]);
  return list;
}

Energy energy_of(const json& value) {
  if (value.is_number()) return {value.get<double>()};
  return value == "conformal" ? Energy::conformal : Energy::isometric;
}

Method method_of(const std::string& name) {
  return *std::find_if(all_methods.begin(), all_methods.end(),
                       [&](Method method) { return name == name_of(method); });
}

PlanarLimits limits_of(const json& planar) {
  PlanarLimits limits;
  limits.depth = planar.value("depth", limits.depth);
  limits.normal_limit = planar.value("normal_limit", limits.normal_limit);
  return limits;
}

UvConflict uv_conflict_of(const std::string& name) {
  static const std::map<std::string, UvConflict> choices = {
      {"separate", UvConflict::separate}, {"error", UvConflict::error}, {"share", UvConflict::share}};
  return choices.at(name);
}

DecalJob decal_of(const json& decal, const std::filesystem::path& folder) {
  DecalJob out;
  out.name = decal["name"].get<std::string>();
  out.image = folder / decal["image"].get<std::string>();
  out.mirrored = decal.value("mirrored", out.mirrored);
  out.region = region_of(decal);
  for (const json& feature : decal["features"])
    out.features.push_back({pixel_of(feature["image"]), place_of(feature), feature.value("depth", 0.0)});
  out.nodes = references_of(decal, "nodes");
  out.materials = references_of(decal, "materials");
  if (decal.contains("size")) out.size = decal["size"].get<double>();
  if (decal.contains("up")) out.up = vector_of(decal["up"]);
  out.opacity = decal.value("opacity", out.opacity);
  if (decal.contains("mask")) out.mask = folder / decal["mask"].get<std::string>();
  out.layers = layers_of(decal, folder);
  out.output = decal.value("output", "bake") == "overlay" ? DecalOutput::overlay : DecalOutput::bake;
  out.instance = decal.value("instance", "this") == "all" ? Instance::all : Instance::only_this;
  out.uv_conflict = uv_conflict_of(decal.value("uv_conflict", "separate"));
  if (decal.contains("offset")) out.offset = decal["offset"].get<double>();
  out.method = method_of(decal.value("method", name_of(out.method)));
  if (decal.contains("planar")) out.planar = limits_of(decal["planar"]);
  if (decal.contains("expmap") && decal["expmap"].value("parents", "upwind") == "one")
    out.parents = Parents::one;
  if (decal.contains("energy")) out.energy = energy_of(decal["energy"]);
  out.guide = decal.value("guide", out.guide);
  out.overlap = decal.value("overlap", "stop") == "allow" ? Overlap::allow : Overlap::stop;
  return out;
}

Result<void> check_names(const std::vector<DecalJob>& decals, const std::string& file) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < decals.size(); ++i) {
    const auto [entry, fresh] = first.emplace(decals[i].name, i);
    if (!fresh)
      return fail(
          ErrorCode::schema_violation,
          fmt::format("{}: /decals/{}/name: found \"{}\", the name of /decals/{} too, expected a name of "
                      "its own for each decal",
                      file, i, decals[i].name, entry->second));
  }
  return {};
}

/// A texture's channel is one layer's, and there is something to be seen.
Result<void> check_layers(const json& decals, const std::string& file) {
  for (std::size_t i = 0; i < decals.size(); ++i) {
    const json layers = decals[i].value("layers", json::object());
    const auto name = decals[i]["name"].get<std::string>();
    const bool colourless = layers.contains("baseColor") && layers["baseColor"] == false;
    if (colourless && layers.size() == 1)
      return fail(ErrorCode::schema_violation,
                  fmt::format("{}: /decals/{}/layers: found no layer beside \"baseColor\": false on decal "
                              "'{}', of which nothing would be seen, expected a layer",
                              file, i, name));
    if (colourless && decals[i].value("output", "bake") == "overlay")
      return fail(ErrorCode::schema_violation,
                  fmt::format("{}: /decals/{}/layers/baseColor: found false on the overlay '{}', which lies "
                              "over the surface and cannot leave its colour in place, expected a base "
                              "colour, or \"output\": \"bake\"",
                              file, i, name));
    for (const char* part : {"metallic", "roughness"})
      if (layers.contains("metallicRoughness") && layers.contains(part))
        return fail(
            ErrorCode::schema_violation,
            fmt::format("{0}: /decals/{1}/layers: found \"{2}\" beside \"metallicRoughness\" on decal '{3}', "
                        "which has it already, expected one of them",
                        file, i, part, name));
  }
  return {};
}

/// Options of a method go with that method.
Result<void> check_method_options(const json& decals, const std::string& file) {
  for (std::size_t i = 0; i < decals.size(); ++i) {
    const std::string method = decals[i].value("method", name_of(Method::applique));
    for (const char* options : {name_of(Method::planar), name_of(Method::expmap)})
      if (decals[i].contains(options) && method != options)
        return fail(
            ErrorCode::schema_violation,
            fmt::format("{0}: /decals/{1}/{2}: found options of the method \"{2}\" on decal '{3}', whose "
                        "method is \"{4}\", expected \"method\": \"{2}\" beside them",
                        file, i, options, decals[i]["name"].get<std::string>(), method));
  }
  return {};
}

}  // namespace

const char* name_of(BlendMode mode) {
  return blend_names[static_cast<std::size_t>(mode)];
}

std::vector<std::filesystem::path> inputs_of(const Job& job) {
  std::vector<std::filesystem::path> inputs = {job.path, job.model};
  for (const DecalJob& decal : job.decals) {
    inputs.push_back(decal.image);
    if (!decal.mask.empty()) inputs.push_back(decal.mask);
    for (const DecalLayer& layer : decal.layers)
      if (!layer.image.empty()) inputs.push_back(layer.image);
  }
  return inputs;
}

std::string label_of(const DecalJob& decal, const DecalLayer& layer) {
  return fmt::format("decal '{}': layer \"{}\"", decal.name, layer.name);
}

std::string mask_label_of(const DecalJob& decal) {
  return fmt::format("decal '{}': mask", decal.name);
}

Result<Job> load_job(const std::filesystem::path& path) {
  APPLIQUE_TRY(const auto bytes, read_file(path));
  const std::string file = path.filename().string();
  APPLIQUE_TRY(const json document, parse_json({bytes.begin(), bytes.end()}, file));
  APPLIQUE_CHECK(check_schema(document, job_schema(), file));
  APPLIQUE_CHECK(check_method_options(document["decals"], file));
  APPLIQUE_CHECK(check_layers(document["decals"], file));

  Job job;
  job.path = path;
  const std::filesystem::path folder = path.parent_path();
  job.model = folder / document["model"].get<std::string>();
  job.texture_size = document.value("texture_size", job.texture_size);
  job.gutter = document.value("gutter", job.gutter);
  const std::string seams = document.value("seams", "auto");
  job.unwrap = seams == "auto" ? Unwrap::unseen : seams == "unwrap" ? Unwrap::always : Unwrap::never;
  job.seams = seams == "sharp" ? SeamFit::sharp : SeamFit::exact;
  if (document.contains("resolution")) job.resolution = document["resolution"].get<int>();
  for (const json& decal : document["decals"]) job.decals.push_back(decal_of(decal, folder));
  APPLIQUE_CHECK(check_names(job.decals, file));
  return job;
}

}  // namespace applique
