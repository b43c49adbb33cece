#pragma once

#include "applique/gpu/camera.h"
#include "applique/gpu/device.h"
#include "applique/image/image.h"

#include "model.h"
#include "solve_job.h"

namespace applique {

struct PictureSize {
  int width = 1200;  ///< Pixels.
  int height = 900;  ///< Pixels.
};

/// Looks straight at a decal, upright, so that it fills the picture.
Camera camera_on_decal(const SolvedDecal& decal, PictureSize size);

/// Looks at the whole model; degrees and zoom as in orbit().
Camera camera_around_model(const Model& model, double azimuth, double elevation, double zoom,
                           PictureSize size);

/// Renders the model with its materials: base colour, metal and roughness, relief and glow. Errors:
/// device_failed, and those of load_model_image.
Result<Image> render_model(const Device& device, const Model& model, const Camera& camera, PictureSize size);

}  // namespace applique
