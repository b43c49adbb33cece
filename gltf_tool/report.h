#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "solve_job.h"

namespace applique {

/// What a bake did to one texture.
struct TextureReport {
  std::string material;                   ///< Name of its material.
  std::string slot;                       ///< "baseColor", …
  int width = 0;                          ///< Texels.
  int height = 0;                         ///< Texels.
  bool created = false;                   ///< The material had no texture there before.
  std::string format;                     ///< As it is stored: "png", "jpeg" or "webp".
  std::uint64_t separated_triangles = 0;  ///< That got texture space of their own.
  std::uint64_t covered_texels = 0;
  std::uint64_t gutter_texels = 0;
  std::uint64_t shared_texels = 0;
};

/// Texture coordinates under a decal through which it cannot simply be baked.
struct UvConflictReport {
  std::optional<std::string> material;  ///< Name; none: the triangles have no material.
  std::vector<std::string> slots;       ///< That the decal writes and that are in conflict: "baseColor", …
  std::string reason;                   ///< "missing", "shared" or "coarse".
  std::string outcome;                  ///< "separate", "share" or "error".
  std::uint64_t triangles = 0;          ///< Of the decal on the material.
  std::uint64_t in_conflict = 0;        ///< Of them.
  std::uint64_t covered_texels = 0;
  std::uint64_t shared_texels = 0;
  std::string message;  ///< All this as a sentence.
};

/// How finely the textures under a decal resolve it, along a line.
struct TexelDensity {
  double texels_per_unit = 0;   ///< Texels a scene unit.
  double texels_per_pixel = 0;  ///< Texels an image pixel.
};

/// What the report tells beyond the solved geometry.
struct ReportInput {
  std::string command;                      ///< "bake" or "check".
  std::optional<std::string> device;        ///< Name of the Vulkan device, if one was used.
  std::optional<std::string> model_output;  ///< Paths that were written.
  std::optional<std::string> preview_output;
  std::optional<std::string> region_output;
  StageTimes times;  ///< Of the whole run.
  double total_seconds = 0;
  std::vector<TextureReport> textures;
  std::vector<std::optional<TexelDensity>> densities;       ///< By decal; may be empty.
  std::vector<std::vector<UvConflictReport>> uv_conflicts;  ///< By decal; may be empty.
  std::vector<Warning> warnings;                            ///< Beyond the model's.
};

/// A feature as a job file takes it: {"image": [x, y], "position": [x, y, z]}, with "depth" unless it is 0.
nlohmann::ordered_json feature_json(const Feature& feature, const Vec3& position);

/// The report of a run, as report.schema.json describes it.
nlohmann::ordered_json make_report(const SolvedJob& job, const ReportInput& input);

}  // namespace applique
