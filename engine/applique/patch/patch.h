#pragma once

#include <array>

#include "applique/base/ids.h"

namespace applique {

/// A triangle of a patch.
struct PatchFace {
  FaceId mesh_face;                       ///< The surface face under it; invalid over a bridged hole.
  std::array<PatchVertexId, 3> vertices;  ///< Corner k lies over corner k of `mesh_face`.
  std::array<PatchFaceId, 3>
      neighbours;  ///< Across the edge opposite corner k; invalid at the patch's boundary.
};

/// An oriented triangulated disc laid over the surface. The map to the surface is an immersion: several patch
/// faces may lie over one surface face, and several patch vertices over one surface vertex, each with its own
/// place in the plane and in the image.
struct Patch {
  IdVector<PatchFaceId, PatchFace> faces;
  IdVector<PatchVertexId, VertexId>
      vertices;  ///< The surface vertex under each; invalid at a bridge's centre.
};

}  // namespace applique
