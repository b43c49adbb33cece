#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/ids.h"
#include "applique/surface/surface_mesh.h"

namespace applique {

/// A triangle of a patch, over a face of the surface (or over a bridged hole: mesh_face invalid).
struct PatchFace {
  FaceId mesh_face;
  std::array<PatchVertexId, 3> vertices;  ///< Corner k lies over corner k of `mesh_face`.
  std::array<PatchFaceId, 3> neighbours;  ///< Across the edge opposite corner k; invalid at the boundary.
};

/// An immersed disc: placeholder until the growth lands; fields stay.
struct Patch {
  IdVector<PatchFaceId, PatchFace> faces;
  IdVector<PatchVertexId, VertexId> vertices;  ///< The surface vertex under each patch vertex.
};

}  // namespace applique
