#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "applique/base/error.h"

#include "commands/common.h"

namespace applique {

struct ExplainArguments {
  std::filesystem::path job;
  std::filesystem::path output;   ///< PNG.
  std::string stage;              ///< One of stage_names().
  std::string decal;              ///< Name; empty: the first one.
  int step = -1;                  ///< -1: not given.
  std::string size = "1200x600";  ///< Pixels, WIDTHxHEIGHT.
  std::string device;             ///< Index or part of a name; empty: the best one.
};

CLI::App* add_explain_command(CLI::App& app, ExplainArguments& arguments);

/// Solves a decal of a job and draws how: a stage of the method as a picture.
Result<void> run_explain(const ExplainArguments& arguments, const CommonArguments& common);

}  // namespace applique
