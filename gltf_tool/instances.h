#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "solve_job.h"

namespace applique {

/// A primitive whose material a bake changes: under one node, or under all nodes that show the mesh and are
/// not listed themselves.
struct TouchedPart {
  std::uint32_t part = 0;   ///< Index in Model::parts; for several nodes, that of one of them.
  bool every_node = false;  ///< It stands for several nodes, and the mesh is not copied for them.
  std::set<std::size_t>
      decals;  ///< Indices in SolvedJob::decals, of those that are seen there; at least one.
};

/// What the job's baked decals touch. A decal for all instances is seen on every node that shows a mesh it
/// lies on; nodes with decals of their own are listed one by one.
std::vector<TouchedPart> find_touched_parts(const SolvedJob& job);

/// Where a decal that shares its texels is to be seen too, for the others that show them: the part that the
/// triangles of `part` were of before they were separated for another decal; none if it is not.
std::optional<std::uint32_t> former_part(const SolvedJob& job, const DecalJob& decal, std::uint32_t part);

/// Which of `parts` shows what a decal puts on the part `source`: that part itself or, for a decal for all
/// instances, one of the same primitive.
std::optional<std::uint32_t> part_that_shows(const Model& model, const DecalJob& decal,
                                             const std::vector<std::uint32_t>& parts, std::uint32_t source);

/// The part that stands for all that a decal changes with `part`: for a decal for all instances, the model's
/// first part of the same primitive; else the part itself.
std::uint32_t part_that_stands_for(const Model& model, const DecalJob& decal, std::uint32_t part);

/// The materials of the surface under a decal; none: that without one.
std::set<std::optional<std::size_t>> materials_under(const SolvedDecal& decal, const Model& model);

/// The names, quoted, of the material variants (KHR_materials_variants) in which the surface under a decal
/// shows another material than by default.
std::vector<std::string> variants_without(const SolvedDecal& decal, const Model& model);

/// Whether a skin moves some of the surface under a decal.
bool lies_on_skin(const SolvedDecal& decal, const Model& model);

/// Whether vertex colours (COLOR_0) that are not white lie under a decal, and so tint it.
bool has_vertex_colours(const SolvedDecal& decal, const Model& model);

}  // namespace applique
