#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "model.h"

namespace applique {

/// What a decal would find on one material, over all triangles that the default scene shows with it.
struct MaterialSummary {
  std::optional<std::size_t> material;  ///< Document index; none for triangles without a material.
  std::string name;
  std::size_t triangles = 0;
  std::size_t triangles_without_uvs = 0;  ///< Without the base colour's texture coordinates.
  std::vector<std::string> uv_sets;       ///< "TEXCOORD_0", …: those that every primitive of it has.
  std::optional<std::array<int, 2>> texture_size;  ///< Pixels; none without a base-colour texture.
  std::string texture_problem;                     ///< Why the texture cannot be decoded; "" when it can.
  std::array<double, 2> uv_lower = {0, 0};         ///< Range of the texture coordinates, before wrapping.
  std::array<double, 2> uv_upper = {0, 0};
  double covered_texels = 0;  ///< Share of the texture under some triangle, 0..1, sampled at 512 x 512.
  double shared_texels = 0;   ///< Share of those under more than one triangle: a decal there is seen twice,
                              ///< unless it gets texture space of its own.
  double mirrored = 0;        ///< Share of the triangles with the rarer UV orientation, 0..0.5.
  std::size_t collapsed_triangles = 0;  ///< With texture coordinates on a line or a point.
  double texel_density = 0;  ///< Texels per scene unit, mean over the area; 0 without texture or UVs.
};

/// A primitive under a node.
struct PartSummary {
  std::size_t node = 0, mesh = 0, primitive = 0;
  std::optional<std::size_t> material;
  std::string node_name, mesh_name;
  std::size_t vertices = 0, triangles = 0;
};

/// What `applique inspect` prints.
struct ModelSummary {
  std::size_t nodes = 0, meshes = 0, scenes = 0, skins = 0, animations = 0,
              cameras = 0;         ///< In the document.
  std::size_t morph_targets = 0;   ///< Most of any primitive that is shown.
  std::vector<PartSummary> parts;  ///< What the default scene shows.
  std::size_t triangles = 0;
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  ///< Bounding box, scene units.
  std::vector<MaterialSummary> materials;           ///< Those that are shown.
  std::size_t surface_vertices = 0;                 ///< Of the welded surface.
  std::size_t components = 0;                       ///< Connected pieces of it.
  std::size_t boundary_edges = 0;                   ///< Open edges, among them the sides of cut ones.
  std::size_t non_manifold_edges = 0;               ///< Edges that were cut open.
  std::size_t split_vertices = 0, degenerate_triangles = 0;
  std::vector<std::string> extensions_used, extensions_required;
  std::vector<Warning> warnings;
};

/// Looks a model over. Images are decoded for their size; the whole takes time proportional to the model.
ModelSummary inspect_model(const Model& model);

/// The summary as `applique inspect --json` prints it: the members under their own names.
nlohmann::ordered_json to_json(const ModelSummary& summary);

}  // namespace applique
