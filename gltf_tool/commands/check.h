#pragma once

#include <filesystem>
#include <optional>

#include <CLI/CLI.hpp>

#include "applique/base/error.h"

#include "commands/common.h"

namespace applique {

struct CheckArguments {
  std::filesystem::path job;
  std::optional<std::filesystem::path> report;  ///< JSON, report.schema.json.
  std::optional<std::filesystem::path>
      dump_region;       ///< JSON: for each decal's name a "region" for a job file.
  bool suggest = false;  ///< Look for features that would lower the stretch.
};

CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments);

/// Solves the geometry of a job and tells how good it is, and where texture coordinates, materials and images
/// are in a decal's way; needs no Vulkan and changes no model. What a bake would refuse is an error, once the
/// report is written.
Result<void> run_check(const CheckArguments& arguments, const CommonArguments& common);

}  // namespace applique
