#include "commands/common.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "output_file.h"
#include "progress.h"
#include "report.h"

namespace applique {
namespace {

constexpr int largest_side = 4096;  // pixels of a picture

std::string extension_of(const std::string& path) {
  return CLI::detail::to_lower(std::filesystem::path(path).extension().string());
}

}  // namespace

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

void log_warnings(const Model& model) {
  for (const Warning& warning : model.warnings) spdlog::warn("{}", warning.message);
}

void log_warnings(const SolvedJob& job) {
  log_warnings(job.model);
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
        std::max(quality.flipped_plane, quality.flipped_image), quality.l2_stretch, 100 * quality.coverage);
  }
}

void log_separations(const std::vector<std::vector<UvConflictReport>>& conflicts) {
  for (const auto& of_decal : conflicts)
    for (const UvConflictReport& conflict : of_decal)
      if (conflict.outcome == "separate") spdlog::info("{}", conflict.message);
}

void log_suggestions(const SolvedJob& job) {
  for (const SolvedDecal& decal : job.decals) {
    if (!decal.suggestion) continue;
    const auto& [stretch, add, leave_out] = *decal.suggestion;
    if (add)
      spdlog::info("{}: a further feature lowers the L2 stretch from {:.4f} to {:.4f}: {}", decal.job.name,
                   stretch, add->l2_stretch, feature_json(add->feature, add->position).dump());
    if (leave_out)
      spdlog::info("{}: without feature {} the L2 stretch falls from {:.4f} to {:.4f}", decal.job.name,
                   leave_out->feature, stretch, leave_out->l2_stretch);
    if (!add && !leave_out)
      spdlog::info("{}: no feature more or less was found to lower the L2 stretch of {:.4f}", decal.job.name,
                   stretch);
  }
}

StageCallback show_stages(Progress& progress, double start, double share) {
  return [&progress, start, share](const std::string& stage, double done) {
    spdlog::debug("{}", stage);
    progress.show(stage, start + share * done);
  };
}

Result<Job> only_decal(Job job, const std::string& decal) {
  if (!decal.empty()) {
    std::erase_if(job.decals, [&](const DecalJob& other) { return other.name != decal; });
    if (job.decals.empty())
      return fail(ErrorCode::json_invalid, fmt::format("{}: has no decal '{}'", job.path.string(), decal));
  }
  job.decals.resize(1);
  return job;
}

PictureSize parse_size(const std::string& text) {
  PictureSize size = {0, 0};
  int length = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%n", &size.width, &size.height, &length) != 2 ||
      static_cast<std::size_t>(length) != text.size())
    return {0, 0};
  return size;
}

const CLI::Validator picture_size(
    [](std::string& text) {
      const PictureSize size = parse_size(text);
      if (std::min(size.width, size.height) >= 1 && std::max(size.width, size.height) <= largest_side)
        return std::string();
      return fmt::format("{}: expected WIDTHxHEIGHT in pixels, each from 1 to {}", text, largest_side);
    },
    "");

const CLI::Validator model_extension(
    [](std::string& path) {
      const std::string extension = extension_of(path);
      if (extension == ".glb" || extension == ".gltf") return std::string();
      return fmt::format("{}: models are written as .glb or .gltf", path);
    },
    "");

const CLI::Validator picture_extension(
    [](std::string& path) {
      if (extension_of(path) == ".png") return std::string();
      return fmt::format("{}: pictures are written as .png", path);
    },
    "");

CLI::Validator number_within(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return std::string();
        return fmt::format("{}: expected a number from {} to {}", text, least, most);
      },
      "");
}

CLI::Validator whole_number_within(int least, std::optional<int> most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        int value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most.value_or(value))
          return std::string();
        return fmt::format("{}: expected a whole number from {}{}", text, least,
                           most ? fmt::format(" to {}", *most) : " on");
      },
      "");
}

}  // namespace applique
