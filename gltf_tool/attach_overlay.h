#pragma once

#include <vector>

#include "applique/base/error.h"

#include "model.h"
#include "overlay.h"
#include "overlay_mesh.h"
#include "solve_job.h"

namespace applique {

/// Hands a decal's mesh to the nodes under it, a part to each, so that it moves with them: in the space of
/// the node's mesh (see OverlayMesh::mirrored), with the joints and morph targets of the surface under each
/// vertex. A vertex inside a triangle blends those of the corners and keeps as many joints, the heaviest, as
/// the model's own vertices have. At rest every vertex is where `mesh` has it; in other poses one at a corner
/// of the surface's triangles keeps exactly to it, one between them nearly.
///
/// What lies on a node whose transform cannot be inverted (a scale of 0) stays in scene space, without a
/// node. Errors: those of load_model.
Result<std::vector<OverlayMesh>> attach_overlay(const Model& model, const SolvedDecal& decal,
                                                const DecalMesh& mesh);

}  // namespace applique
