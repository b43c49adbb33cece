#include "commands/common.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "output_file.h"
#include "progress.h"

namespace applique {

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& examples) {
  CLI::App* subcommand = app.add_subcommand(name, description);
  subcommand->fallthrough();
  subcommand->footer("Examples:\n" + examples);
  return subcommand;
}

Result<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& document) {
  return write_file(path,
                    document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void log_warnings(const SolvedJob& job) {
  for (const Warning& warning : job.model.warnings) spdlog::warn("{}", warning.message);
  for (const SolvedDecal& decal : job.decals)
    for (const Warning& warning : decal.warnings) spdlog::warn("{}", warning.message);
}

void log_decals(const SolvedJob& job) {
  for (const SolvedDecal& decal : job.decals) {
    const MapQuality& quality = decal.map.quality;
    const auto& residuals = quality.feature_residual;
    const double residual = residuals.empty() ? 0 : *std::max_element(residuals.begin(), residuals.end());
    spdlog::info(
        "{}: {} features within {:.1g} px, {} triangles, {} flipped, L2 stretch {:.3f}, {:.2f} % covered",
        decal.job.name, decal.features.size(), residual, decal.map.patch.faces.size(),
        quality.flipped_plane + quality.flipped_image, quality.l2_stretch, 100 * quality.coverage);
  }
}

StageCallback show_stages(Progress& progress, double start, double share) {
  return [&progress, start, share](const std::string& stage, double done) {
    spdlog::debug("{}", stage);
    progress.show(stage, start + share * done);
  };
}

const CLI::Validator model_extension(
    [](std::string& path) {
      const std::string extension = std::filesystem::path(path).extension().string();
      if (extension == ".glb" || extension == ".gltf") return std::string();
      return fmt::format("{}: models are written as .glb or .gltf", path);
    },
    "");

}  // namespace applique
