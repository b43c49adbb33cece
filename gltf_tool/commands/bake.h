#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "applique/base/error.h"

#include "commands/common.h"
#include "texture_encoding.h"

namespace applique {

struct BakeArguments {
  std::filesystem::path job;
  std::filesystem::path output;                  ///< .glb or .gltf.
  std::optional<std::filesystem::path> report;   ///< JSON, report.schema.json.
  std::optional<std::filesystem::path> preview;  ///< PNG.
  std::string device;                            ///< Index or part of a name; empty: the best one.
  TextureEncoding textures;
};

CLI::App* add_bake_command(CLI::App& app, BakeArguments& arguments);

/// Solves a job and writes the model with its decals.
Result<void> run_bake(const BakeArguments& arguments, const CommonArguments& common);

}  // namespace applique
