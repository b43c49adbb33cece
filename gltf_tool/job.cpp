#include "job.h"

#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

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

BlendMode blend_of(const std::string& name) {
  static const std::map<std::string, BlendMode> modes = {
      {"normal", BlendMode::normal}, {"multiply", BlendMode::multiply}, {"screen", BlendMode::screen}};
  return modes.at(name);
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
  out.blend = blend_of(decal.value("blend", "normal"));
  out.output = decal.value("output", "bake") == "overlay" ? DecalOutput::overlay : DecalOutput::bake;
  if (decal.contains("offset")) out.offset = decal["offset"].get<double>();
  out.method = decal.value("method", "applique") == "paper" ? Method::paper : Method::applique;
  out.energy = decal.value("energy", "isometric") == "conformal" ? Energy::conformal : Energy::isometric;
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

}  // namespace

Result<Job> load_job(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (!stream || std::filesystem::is_directory(path) || !(text << stream.rdbuf()))
    return fail(ErrorCode::file_unreadable, fmt::format("{}: the job file cannot be read", path.string()));

  const std::string file = path.filename().string();
  APPLIQUE_TRY(const json document, parse_json(text.str(), file));
  APPLIQUE_CHECK(check_schema(document, job_schema(), file));

  Job job;
  job.path = path;
  const std::filesystem::path folder = path.parent_path();
  job.model = folder / document["model"].get<std::string>();
  job.texture_size = document.value("texture_size", job.texture_size);
  for (const json& decal : document["decals"]) job.decals.push_back(decal_of(decal, folder));
  APPLIQUE_CHECK(check_names(job.decals, file));
  return job;
}

}  // namespace applique
