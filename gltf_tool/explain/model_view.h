#pragma once

#include <span>
#include <vector>

#include "applique/gpu/device.h"
#include "applique/image/draw.h"

#include "explain/image_view.h"
#include "explain/layout.h"
#include "solve_job.h"

/// Drawings on the model: plain grey, with coloured faces, lines and numbered features.
namespace applique {

/// Lines on the surface, drawn as tubes.
struct SurfaceLines {
  std::vector<std::vector<Vec3>> lines;
  double width = 1;  ///< Pixels, at the middle of the picture.
  draw::Rgba colour;
};

/// Faces of the decal's surface in one colour.
struct SurfaceTint {
  std::vector<FaceId> faces;
  draw::Rgba colour;
};

/// What is to be seen on the model.
struct ModelDrawing {
  std::vector<SurfaceTint> tints;  ///< Where they overlap, later ones count.
  std::vector<SurfaceLines> lines;
  const Image* painting = nullptr;  ///< Stuck on in place of the decal's image; null: none.
  bool features = true;             ///< Numbered; pale where the model hides them.
};

/// Looks straight at the decal, with some of the model around it.
Camera camera_for_drawing(const SolvedDecal& decal, const Box& box);

/// Paints the drawing into the box. Errors: device_failed.
Result<void> draw_model(draw::Canvas& canvas, const Device& device, const Model& model,
                        const SolvedDecal& decal, const ModelDrawing& drawing, const Camera& camera,
                        const Box& box);

/// The edges of the patch's faces on the surface, each once.
std::vector<std::vector<Vec3>> edges_on_surface(const SolvedDecal& decal, const Patch& patch);

/// The surface faces under the patch's.
std::vector<FaceId> faces_on_surface(const Patch& patch);

}  // namespace applique
