#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>

#include "applique/base/types.h"
#include "applique/surface/surface_mesh.h"
#include "applique/surface/surface_query.h"

#include "model.h"

namespace applique {

/// A node, material or mesh of the document: its index, or its name.
using Reference = std::variant<std::size_t, std::string>;

/// The surface point nearest to a point of the scene at rest.
struct PositionPlace {
  Vec3 position = Vec3::Zero();
  std::optional<double> max_distance;  ///< Scene units; left out: 2 % of the model's diagonal.
};

/// The surface point with these texture coordinates (of the base colour, as glTF stores them: v down).
struct UvPlace {
  std::array<double, 2> uv = {0, 0};
  Reference material;
};

/// A vertex of a primitive, by its index in the primitive's attributes.
struct VertexPlace {
  std::size_t vertex = 0;
  Reference mesh;
  std::size_t primitive = 0;
};

/// A point in a triangle of a primitive, by the triangle's index in drawing order.
struct TrianglePlace {
  std::size_t triangle = 0;
  std::array<double, 3> barycentric = {1, 0,
                                       0};  ///< Weights of its corners in the file's order, >= 0, sum 1.
  Reference mesh;
  std::size_t primitive = 0;
};

/// The first point of the surface that a ray meets.
struct RayPlace {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  ///< Any length > 0.
};

/// Where a feature lies on a model.
using Place = std::variant<PositionPlace, UvPlace, VertexPlace, TrianglePlace, RayPlace>;

/// The point of the surface (of `model`, perhaps limited to nodes and materials) that a place means; `query`
/// is over `surface.mesh`. Texture coordinates are those of the base-colour texture with
/// KHR_texture_transform applied, so a point of the picture; they are wrapped as the material's sampler does,
/// and where several triangles share them the first one in drawing order is meant. Errors begin with `owner`
/// ("decal 'crest', feature 3"): feature_too_far (distance and limit), feature_missed (no triangle has the
/// texture coordinates, or the ray meets none), feature_place_invalid (a mesh, primitive, vertex, triangle or
/// material that is not there or not on the surface; barycentrics that are negative or whose sum is off 1 by
/// more than 1e-6), uvs_missing.
Result<SurfacePoint> resolve_place(const Place& place, const Model& model, const ModelSurface& surface,
                                   const SurfaceQuery& query, const std::string& owner);

}  // namespace applique
