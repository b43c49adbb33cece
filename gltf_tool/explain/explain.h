#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "applique/gpu/device.h"
#include "applique/image/image.h"

#include "model_picture.h"
#include "solve_job.h"

namespace applique {

/// What a picture explains.
enum class Stage {
  region,      ///< Contour and features, pairs, triangulation, groups (Fig. 13).
  graph,       ///< Visible pairs, the planar graph, the tree (Fig. 3 of the paper).
  paths,       ///< The tree in the image, and as shortest paths on the model (Fig. 5).
  seed,        ///< The first patch on the model, and its embedding (Fig. 8).
  growth,      ///< The embedded patch and the warped contour, step by step (Fig. 9, 15 to 17).
  warp,        ///< The image and what the warp makes of it in the plane (Fig. 12, 20).
  influence,   ///< Where which group moves the image; its segments (Fig. 13).
  patch,       ///< The final patch on the model, and in texture coordinates (Fig. 22).
  distortion,  ///< How the map changes areas (above) and angles (below), on the model and in the image.
};

struct StageName {
  const char* name;
  Stage stage;
};
const std::vector<StageName>& stage_names();

struct ExplainOptions {
  Stage stage = Stage::region;
  std::optional<std::size_t> step;  ///< From 0, for growth (left out: several) and warp (left out: the last).
  PictureSize size = {1200, 600};
};

/// Whether the stage's picture shows the model, so that it needs a device.
bool shows_model(const ExplainOptions& options);

/// Draws a stage of how a decal was solved: white background, panels side by side. The decal was solved with
/// a trace; `device` may be null for stages that do not show the model. Errors: device_failed; option_invalid
/// when the growth has no such step.
Result<Image> explain_decal(const Model& model, const SolvedDecal& decal, const Device* device,
                            const ExplainOptions& options);

}  // namespace applique
