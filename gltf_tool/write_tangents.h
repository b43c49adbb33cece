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
///
/// (Of nodes that mirror glTF only says that their triangles are wound the other way, §3.7.4; of tangents,
/// §3.7.2.1, that the bitangent is cross(normal, tangent) * w, not in which space, and the two differ in sign
/// there. Khronos's sample viewer, three.js and PlayCanvas take the product in the scene, Babylon.js in the
/// mesh's space: whatever w is, some show the relief upside down. Without tangents the frames follow from the
/// texture coordinates alone, and all agree; the validator's MESH_PRIMITIVE_GENERATED_TANGENT_SPACE is the
/// price. An overlay has a node that turns it back; a model's mesh could have that only if it was rewritten.)
Result<void> write_tangents(const Model& model, std::span<const BakeTarget> targets, Document& document);

/// Gives an overlay MikkTSpace's tangents. It stays without where its joints mirror, or where a part of the
/// decal is turned over against another.
void make_tangents(OverlayMesh& overlay);

}  // namespace applique
