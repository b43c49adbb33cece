#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "applique/base/error.h"
#include "applique/base/types.h"

#include "document.h"

namespace applique {

/// The geometry of a checked document, uncompressed: accessors, meshes, nodes, skins and scenes with one
/// buffer. Images, materials and animations are left out. Indices of nodes, meshes, primitives and skins are
/// the document's; those of accessors are not, where a primitive was compressed with Draco. Errors:
/// model_invalid, model_unsupported.
Result<tinygltf::Model> decode_geometry(const Document& document, const Buffers& buffers);

/// The elements of an accessor as doubles, `components` an element, one after the other: every component
/// type, normalized integers as [0,1] or [-1,1], sparse accessors filled in. `what` names the owner in errors
/// ("mesh 0, primitive 1, POSITION"). Errors: model_invalid when the type is not the expected one, when the
/// data lie outside their buffer, or when a number is not finite.
Result<std::vector<double>> read_accessor(const tinygltf::Model& model, int accessor, int components,
                                          const std::string& what);

/// The elements of an accessor of scalars or vectors as they are stored: normalized integers stay integers.
/// `components` is set to the components of an element.
Result<std::vector<double>> read_stored(const tinygltf::Model& model, int accessor, int& components,
                                        const std::string& what);

/// The elements of a scalar or vector accessor of unsigned integers, one after the other.
Result<std::vector<std::uint32_t>> read_integers(const tinygltf::Model& model, int accessor, int components,
                                                 const std::string& what);

/// Three numbers each.
std::vector<Vec3> to_vectors(const std::vector<double>& values);

}  // namespace applique
