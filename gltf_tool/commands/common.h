#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "applique/base/error.h"

#include "model_picture.h"
#include "report.h"
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

/// Tells the warnings of the model, and of the decals.
void log_warnings(const Model& model);
void log_warnings(const SolvedJob& job);

/// One line about each decal: "tiger: 5 features within 2e-13 px, 5796 triangles, …".
void log_decals(const SolvedJob& job);

/// Which triangles get texture space of their own, and why.
void log_separations(const std::vector<std::vector<UvConflictReport>>& conflicts);

/// What was suggested for each decal, if it was asked for: the further feature as a job file has it, the one
/// too many, and the L2 stretch with and without.
void log_suggestions(const SolvedJob& job);

/// A callback that shows stages on a progress bar, as the part of the whole work that begins at `start` and
/// takes `share`, both 0..1; and logs them.
StageCallback show_stages(class Progress& progress, double start, double share);

/// The job with one decal alone: the one of this name, or the first if the name is empty. Errors:
/// json_invalid when it has no such decal.
Result<Job> only_decal(Job job, const std::string& decal);

/// "1200x900" as a size; a side of 0 if it is nothing of the kind.
PictureSize parse_size(const std::string& text);

/// For options that name the size of a picture: what parse_size understands, 1 to 4096 pixels a side.
extern const CLI::Validator picture_size;

/// For options that name a model to write: .glb or .gltf, in any case.
extern const CLI::Validator model_extension;

/// For options that name a picture to write: .png, in any case.
extern const CLI::Validator picture_extension;

/// For options that are numbers: finite, `least` to `most`.
CLI::Validator number_within(double least, double most);

/// For options that are whole numbers: `least` to `most`; none: as large as an int can be.
CLI::Validator whole_number_within(int least, std::optional<int> most = std::nullopt);

}  // namespace applique
