#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "applique/base/error.h"

#include "solve_job.h"

namespace applique {

/// Options of every subcommand.
struct CommonArguments {
  bool quiet = false;    ///< Errors only.
  bool verbose = false;  ///< Tells every stage.
};

/// Adds a subcommand that also takes the options of the whole program; `examples` end its help.
CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& examples);

/// Writes a JSON document, indented, with a newline at its end. Errors: output_unwritable.
Result<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& document);

/// Tells the warnings of the model and of the decals.
void log_warnings(const SolvedJob& job);

/// One line about each decal: "tiger: 5 features within 2e-13 px, 5796 triangles, …".
void log_decals(const SolvedJob& job);

/// A callback that shows stages on a progress bar, as the part of the whole work that begins at `start` and
/// takes `share`, both 0..1; and logs them.
StageCallback show_stages(class Progress& progress, double start, double share);

/// For options that name a model to write: .glb or .gltf.
extern const CLI::Validator model_extension;

}  // namespace applique
