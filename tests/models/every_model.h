#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace applique {

/// What became of a decal on a model.
struct ModelRow {
  std::string model;                  ///< Path below the data.
  std::size_t triangles = 0;          ///< 0: it cannot be read, or has none.
  int inspect_status = -1;            ///< Exit code; -1 if it crashed or did not end.
  int bake_status = -1;               ///< Likewise; that of `inspect` where there is nothing to bake on.
  std::string sentence;               ///< Why it was turned down, in the program's words.
  std::string coverage;               ///< The report's coverage_status.
  double l2 = 0;                      ///< Stretch; 1 is none.
  double residual_px = 0;             ///< How far the feature is off.
  std::vector<std::string> warnings;  ///< Codes.
  double seconds = 0;                 ///< Of the bake.
  std::filesystem::path output;       ///< The baked model; empty if there is none.

  [[nodiscard]] bool solved() const { return bake_status == 0; }
};

/// What every decal says besides its place.
struct DecalWish {
  std::string members = "{}";  ///< JSON.
  double larger = 1;           ///< Times the size that fits on the piece.
  std::size_t every = 1;       ///< Only each model whose number is a multiple of this.
};

/// Puts a decal on the largest smooth piece of every model below `data`/gltf and `data`/derived/gltf, by the
/// program `command`. Jobs, models, previews and reports go to `folder`.
std::vector<ModelRow> bake_every_model(const std::filesystem::path& command,
                                       const std::filesystem::path& data, const std::filesystem::path& folder,
                                       const DecalWish& wish = {});

/// The rows as a Markdown table.
std::string table_of(const std::vector<ModelRow>& rows);

}  // namespace applique
