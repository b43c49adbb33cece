#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <tiny_gltf.h>

#include "bake_plan.h"
#include "overlay.h"

namespace applique {

/// A part in its mesh's own space, wound as in the file; none if it has no normals. `geometry` is
/// decode_geometry's. Errors: model_invalid.
Result<std::optional<ModelPart>> in_own_space(const ModelPart& part, const tinygltf::Model& geometry);

/// Gives the primitives under targets that get a normal map their tangents, where they have none:
/// MikkTSpace's, as the normals were turned into, so that viewers need not make their own. A primitive
/// without normals of its own has flat ones, and then a file's tangents do not count; a vertex between
/// surfaces that the texture shows mirrored against one another has no one tangent; and under a node that
/// mirrors viewers differ in whether a tangent's sign holds in the mesh's space or in the scene: such
/// primitives stay without. `document` has the targets' materials. Errors: those of load_model.
Result<void> write_tangents(const Model& model, std::span<const BakeTarget> targets, Document& document);

/// Gives an overlay MikkTSpace's tangents. It stays without where its joints mirror, or where a part of the
/// decal is turned over against another.
void make_tangents(OverlayMesh& overlay);

}  // namespace applique
