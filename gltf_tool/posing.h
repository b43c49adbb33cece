#pragma once

#include <optional>
#include <span>
#include <vector>

#include <tiny_gltf.h>

#include "applique/base/error.h"

#include "document.h"
#include "edit.h"
#include "rig.h"

namespace applique {

/// From each node's space into the scene, at rest.
std::vector<Eigen::Matrix4d> world_matrices(const tinygltf::Model& geometry);

/// None where the node has no skin or the primitive no weights. Errors: model_invalid.
Result<std::optional<Skinning>> read_skinning(const Document& document, const tinygltf::Model& geometry,
                                              std::span<const Eigen::Matrix4d> world, const PartKey& part);

/// Errors: model_invalid.
Result<MorphTarget> read_morph_target(const Document& document, const tinygltf::Model& geometry,
                                      const PartKey& part, std::size_t target);

/// The weights of the morph targets at rest: the node's, else the mesh's, else none.
const std::vector<double>& rest_weights(const tinygltf::Model& geometry, const PartKey& part);

}  // namespace applique
