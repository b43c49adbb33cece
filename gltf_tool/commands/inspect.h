#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

#include "applique/base/error.h"

#include "commands/common.h"

namespace applique {

struct InspectArguments {
  std::filesystem::path model;
  bool json = false;  ///< For programs instead of people.
};

CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments);

/// Tells on standard output what is in a model: what a job can refer to.
Result<void> run_inspect(const InspectArguments& arguments, const CommonArguments& common);

}  // namespace applique
