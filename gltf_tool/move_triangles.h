#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tiny_gltf.h>

#include "applique/base/error.h"

#include "document.h"
#include "model.h"

namespace applique {

/// Triangles of a part that are to be a primitive of their own, with new texture coordinates.
struct MovedTriangles {
  std::uint32_t part = 0;                                     ///< Index in Model::parts.
  std::vector<std::uint32_t> triangles;                       ///< Indices in its triangles, distinct.
  std::vector<std::array<std::array<float, 2>, 3>> uvs;       ///< By moved triangle and corner.
  std::vector<std::array<std::array<float, 4>, 3>> tangents;  ///< The same; empty: they stay.
  std::size_t material = 0;                                   ///< Of the new primitive.
  std::optional<std::size_t> rest_material;                   ///< Of what is left of the old one.
  std::size_t uv_set = 0;  ///< The TEXCOORD that the coordinates become. 0: they replace all sets.
};

/// The old primitive keeps the other triangles; if there are none, the new one takes its place, else it comes
/// last in the mesh. Vertices are copied, with all their attributes and morph targets, for each place in the
/// new coordinates and each new tangent. The old accessors stay, for remove_unused_accessors.
///
/// `model` and `geometry` (decode_geometry's) are of the document before any change to it; `document` is the
/// changed one, in which only the part's node shows its mesh. Returns the new primitive's index. Errors:
/// model_invalid.
Result<std::size_t> move_triangles(Document& document, const Model& model, const tinygltf::Model& geometry,
                                   const MovedTriangles& moved);

/// The accessors that a primitive names.
std::vector<std::size_t> accessors_of(const Document::Json& primitive);

}  // namespace applique
