#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "applique/base/error.h"

#include "report.h"
#include "solve_job.h"
#include "uv_layout.h"

namespace applique {

/// Parts of the model that show one texture and stay together in a bake, and the decals on them.
struct TextureGroup {
  std::optional<std::size_t> material;
  std::vector<std::uint32_t> parts;     ///< Indices in Model::parts, ascending; see part_that_stands_for.
  std::array<int, 2> texture = {0, 0};  ///< Texels of its base colour; of the one that a bake would make.
  bool has_texture = false;
  std::set<MaterialSlot> written;  ///< What the decals on it write.
};

/// The groups that the job's baked decals touch. Errors: those of read_image_bytes.
Result<std::vector<TextureGroup>> find_texture_groups(const SolvedJob& job);

/// What is wrong with texture coordinates under a decal.
enum class UvTrouble {
  missing,  ///< There are none.
  shared,   ///< Other triangles of the group show the same texels.
  coarse,   ///< The decal's detail would be lost in them.
  seams,    ///< The decal crosses from one island to another that is out of step, and is unwrapped.
};

/// A decal that cannot be baked through a group's texture coordinates, or not without being seen elsewhere.
struct UvFinding {
  std::size_t decal = 0;                     ///< Index in SolvedJob::decals.
  std::vector<SeparatedTriangle> triangles;  ///< All that it has in the group.
  UvTrouble trouble = UvTrouble::shared;
  std::vector<MaterialSlot> slots;   ///< Of those that it writes, the ones with trouble.
  std::uint64_t in_conflict = 0;     ///< Of the triangles, those with trouble.
  std::uint64_t covered_texels = 0;  ///< Of the slot with the most that are shared.
  std::uint64_t shared_texels = 0;   ///< Of them, those that other triangles show too.
  /// The mesh has decals for all of its instances, and for some: neither can be separated.
  bool mixed_instances = false;
  UvConflict outcome = UvConflict::separate;  ///< What the decal asks for; "error" where that cannot be.
};

/// What the job's decals find in a group, in their order. Errors: those of slot_texture_size.
Result<std::vector<UvFinding>> find_uv_conflicts(const SolvedJob& job, const TextureGroup& group);

/// The same for all groups. Errors: those of find_texture_groups too.
struct GroupFindings {
  TextureGroup group;
  std::vector<UvFinding> findings;
};
Result<std::vector<GroupFindings>> find_uv_conflicts(const SolvedJob& job);

/// What a report says of a finding.
UvConflictReport report_of(const SolvedJob& job, const TextureGroup& group, const UvFinding& finding);

/// The error of a finding whose outcome it is: uvs_missing or uvs_shared.
Error error_of(const SolvedJob& job, const TextureGroup& group, const UvFinding& finding);

/// A material's name in quotes, for sentences.
std::string quoted_name(const Model& model, std::optional<std::size_t> material);

}  // namespace applique
