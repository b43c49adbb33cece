#include "report.h"

#include <cmath>
#include <numbers>

#include "version.h"

namespace applique {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity: null stands for it.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

const char* name_of(Coverage status) {
  switch (status) {
    case Coverage::covered:
      return "covered";
    case Coverage::clipped_by_boundary:
      return "clipped_by_boundary";
    case Coverage::clipped_by_cover:
      return "clipped_by_cover";
    case Coverage::clipped_in_plane:
      return "clipped_in_plane";
    case Coverage::clipped_closed:
      return "clipped_closed";
    case Coverage::clipped_by_limits:
      return "clipped_by_limits";
    case Coverage::not_converged:
      return "not_converged";
  }
  return "not_converged";
}

Json seconds_of(const StageTimes& times, double total) {
  Json seconds = Json::object();
  for (const auto& [stage, value] : times.stages()) seconds[stage] = value;
  seconds["total"] = total;
  return seconds;
}

Json warnings_of(const std::vector<Warning>& warnings) {
  Json list = Json::array();
  for (const Warning& warning : warnings)
    list.push_back({{"code", warning.code}, {"message", warning.message}});
  return list;
}

Json features_of(const SolvedDecal& decal) {
  Json list = Json::array();
  for (std::size_t i = 0; i < decal.features.size(); ++i) {
    const Feature& solved = decal.features[i];
    Json feature = feature_json(solved, position_of(decal.whole_surface->mesh, solved.surface));
    feature["residual_px"] = decal.map.quality.feature_residual.at(i);
    list.push_back(std::move(feature));
  }
  return list;
}

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// Null by methods that have no such warp.
Json stress_of(const SolvedDecal& decal) {
  const WarpStress& stress = decal.map.stress;
  if (stress.features.empty()) return nullptr;
  Json features = Json::array(), pairs = Json::array();
  for (const FeatureStress& feature : stress.features)
    features.push_back({{"shift_px", feature.shift * decal.region.frame().pixels_per_unit()},
                        {"scale", feature.scale},
                        {"turn_degrees", degrees(feature.turn)}});
  for (const auto& [pair, scale, turn] : stress.pairs)
    pairs.push_back({{"features", pair}, {"scale", scale}, {"turn_degrees", degrees(turn)}});
  return {{"features", std::move(features)}, {"pairs", std::move(pairs)}};
}

/// Null where it was not asked for.
Json suggestions_of(const SolvedDecal& decal) {
  if (!decal.suggestion) return nullptr;
  const auto& [stretch, add, leave_out] = *decal.suggestion;
  Json out = {{"l2", stretch}, {"add", nullptr}, {"leave_out", nullptr}};
  if (add) {
    out["add"] = feature_json(add->feature, add->position);
    out["add"]["l2"] = add->l2_stretch;
  }
  if (leave_out) out["leave_out"] = {{"feature", leave_out->feature}, {"l2", leave_out->l2_stretch}};
  return out;
}

Json decal_seconds(const SolvedDecal& decal) {
  StageTimes times = decal.times;
  double total = 0;
  for (const auto& stage : times.stages()) total += stage.second;
  const SolveTimes& solve = decal.map.times;
  times.add("solve_graph", solve.graph);
  times.add("solve_seed", solve.seed);
  times.add("solve_grow", solve.grow);
  times.add("solve_embed", solve.embed);
  times.add("solve_warp", solve.warp);
  times.add("solve_quality", solve.quality);
  return seconds_of(times, total);
}

Json uv_conflicts_of(const std::vector<UvConflictReport>& conflicts) {
  Json list = Json::array();
  for (const UvConflictReport& conflict : conflicts)
    list.push_back({{"material", conflict.material ? Json(*conflict.material) : Json(nullptr)},
                    {"slots", conflict.slots},
                    {"reason", conflict.reason},
                    {"outcome", conflict.outcome},
                    {"triangles", conflict.triangles},
                    {"triangles_in_conflict", conflict.in_conflict},
                    {"covered_texels", conflict.covered_texels},
                    {"shared_texels", conflict.shared_texels},
                    {"message", conflict.message}});
  return list;
}

Json decal_of(const SolvedDecal& decal, const std::optional<TexelDensity>& density,
              const std::vector<UvConflictReport>& conflicts) {
  const DecalMap& map = decal.map;
  const MapQuality& quality = map.quality;
  std::size_t textured = 0;
  for (const char face : map.textured) textured += face != 0 ? 1 : 0;
  Json out;
  out["name"] = decal.job.name;
  out["image"] = decal.job.image.string();
  out["output"] = decal.job.output == DecalOutput::bake ? "bake" : "overlay";
  out["method"] = name_of(decal.job.method);
  out["coverage_status"] = name_of(map.status);
  out["coverage"] = quality.coverage;
  out["area"] = quality.area;
  out["patch"] = {{"triangles", map.patch.faces.size()},
                  {"textured_triangles", textured},
                  {"vertices", map.patch.vertices.size()},
                  {"divided", map.divided != nullptr},
                  {"iterations", map.solves},
                  {"sheets", map.sheets},
                  {"groups", map.groups}};
  out["features"] = features_of(decal);
  out["stress"] = stress_of(decal);
  out["flipped"] = {{"embedding", quality.flipped_plane}, {"image", quality.flipped_image}};
  out["stretch"] = {{"l2", finite(quality.l2_stretch)}, {"linf", finite(quality.linf_stretch)}};
  out["distortion"] = {{"angle", finite(quality.angle_distortion)},
                       {"area", finite(quality.area_distortion)}};
  out["suggestions"] = suggestions_of(decal);
  out["uv_conflicts"] = uv_conflicts_of(conflicts);
  out["texel_density"] = nullptr;
  if (density)
    out["texel_density"] = {{"texels_per_unit", density->texels_per_unit},
                            {"texels_per_pixel", density->texels_per_pixel}};
  out["seconds"] = decal_seconds(decal);
  out["warnings"] = warnings_of(decal.warnings);
  return out;
}

Json textures_of(const std::vector<TextureReport>& textures) {
  Json list = Json::array();
  for (const TextureReport& texture : textures)
    list.push_back({{"material", texture.material},
                    {"slot", texture.slot},
                    {"width", texture.width},
                    {"height", texture.height},
                    {"created", texture.created},
                    {"format", texture.format},
                    {"separated_triangles", texture.separated_triangles},
                    {"covered_texels", texture.covered_texels},
                    {"gutter_texels", texture.gutter_texels},
                    {"shared_texels", texture.shared_texels}});
  return list;
}

}  // namespace

Json feature_json(const Feature& feature, const Vec3& position) {
  Json out = {{"image", {feature.image.x, feature.image.y}},
              {"position", {position.x(), position.y(), position.z()}}};
  if (feature.depth != 0) out["depth"] = feature.depth;
  return out;
}

Json make_report(const SolvedJob& job, const ReportInput& input) {
  Json report;
  report["version"] = 1;
  report["applique"] = version;
  report["command"] = input.command;
  report["job"] = job.job.path.string();
  report["model"] = job.job.model.string();
  report["device"] = input.device ? Json(*input.device) : Json(nullptr);
  report["outputs"] = Json::object();
  if (input.model_output) report["outputs"]["model"] = *input.model_output;
  if (input.preview_output) report["outputs"]["preview"] = *input.preview_output;
  if (input.region_output) report["outputs"]["region"] = *input.region_output;
  report["seconds"] = seconds_of(input.times, input.total_seconds);
  std::vector<Warning> warnings = job.model.warnings;
  warnings.insert(warnings.end(), input.warnings.begin(), input.warnings.end());
  report["warnings"] = warnings_of(warnings);
  report["textures"] = textures_of(input.textures);
  report["decals"] = Json::array();
  for (std::size_t i = 0; i < job.decals.size(); ++i)
    report["decals"].push_back(
        decal_of(job.decals[i], i < input.densities.size() ? input.densities[i] : std::nullopt,
                 i < input.uv_conflicts.size() ? input.uv_conflicts[i] : std::vector<UvConflictReport>()));
  return report;
}

}  // namespace applique
