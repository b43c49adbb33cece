#pragma once

#include "applique/image/image.h"

#include "model.h"
#include "overlay.h"
#include "solve_job.h"

namespace applique {

/// Lays the decal's faces out as a mesh: those that meet the region, divided until the linear texture
/// coordinates of every triangle lie within `max_deviation` pixels of the exact map (edges are divided for
/// both their faces at once, so no crack opens), cut at the image's border, and moved by `offset` (scene
/// units, >= 0) along the normal, which is the area-weighted mean of the model's normals at a vertex.
///
/// Where the region overlaps itself, sheet after sheet follows from the bottom up, and each lies one more
/// `offset` above the surface. Where faces of several sheets meet, their vertices go with the highest, so
/// that nothing tears; a lower sheet then rises to the upper one there.
OverlayMesh build_overlay_mesh(const Model& model, const SolvedDecal& decal, double offset,
                               double max_deviation = 0.25);

/// The offset of an overlay for which the job names none: 0.05 % of the model's diagonal.
double default_offset(const Model& model);

/// The picture for it: the decal's image, with the alpha multiplied by the region's coverage of each pixel
/// and by the opacity.
Image overlay_image(const SolvedDecal& decal);

}  // namespace applique
