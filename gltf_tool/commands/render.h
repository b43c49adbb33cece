#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "applique/base/error.h"

#include "commands/common.h"

namespace applique {

struct RenderArguments {
  std::filesystem::path model;
  std::filesystem::path output;              ///< PNG.
  std::string size = "1200x900";             ///< Pixels, WIDTHxHEIGHT.
  double azimuth = 0;                        ///< Degrees to the right, from the front (+z).
  double elevation = 0;                      ///< Degrees up.
  double zoom = 1;                           ///< 1: the whole model fills the picture; larger: closer.
  std::optional<std::filesystem::path> job;  ///< With `decal`: the camera looks straight at that decal.
  std::string decal;
  std::optional<std::filesystem::path> camera;  ///< To be written: where the picture is taken from.
  std::string device;                           ///< Index or part of a name; empty: the best one.
};

CLI::App* add_render_command(CLI::App& app, RenderArguments& arguments);

/// Renders a model with its textures and simple light, without a display.
Result<void> run_render(const RenderArguments& arguments, const CommonArguments& common);

}  // namespace applique
