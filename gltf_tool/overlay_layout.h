#pragma once

#include "applique/image/image.h"

#include "model.h"
#include "overlay_mesh.h"
#include "solve_job.h"

namespace applique {

/// An overlay: its triangles, and the picture for them.
struct OverlayLayout {
  DecalMesh mesh;
  Image picture;
  bool divided_skin =
      false;  ///< Between the corners of a skin's triangles it follows the surface only nearly.
};

/// Lays a decal out as an overlay, `offset` (scene units, >= 0) above the surface.
///
/// On nodes without a skin the mesh is build_overlay_mesh's and the picture the decal's image. A skin moves
/// what lies between a triangle's corners otherwise than a vertex there would move, so on nodes with one the
/// triangles stay whole: then the picture is what bends, laid out in the plane of the decal's map, with a
/// margin of nothing around it for what of the triangles sticks out. (Where the image overlaps itself there
/// is no such plane; the triangles are divided all the same.)
OverlayLayout lay_out_overlay(const Model& model, const SolvedDecal& decal, double offset);

}  // namespace applique
