#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "applique/base/error.h"

#include "material.h"
#include "report.h"
#include "solve_job.h"
#include "texture_encoding.h"

namespace applique {

/// What separate_uvs found and did.
struct SeparatedUvs {
  std::vector<std::uint32_t> parts;  ///< Of the new model, those of separated triangles, ascending.
  std::vector<std::vector<UvConflictReport>> conflicts;  ///< By decal.
  std::set<std::pair<std::size_t, MaterialSlot>> made;   ///< Textures that their materials did not have.
  std::vector<Warning> warnings;                         ///< Of the textures: texture_is_png.
};

/// Gives triangles under the job's baked decals texture space of their own where they have none, or share
/// it: where in a slot that the decal writes, other triangles of the model show the same texels (mirrored
/// halves, tiles, stacked islands), where their texture coordinates are too coarse for a decal, where there
/// are none at all, and, if the job unwraps seams, where a decal crosses from one island to another. Decals
/// whose "uv_conflict" is "share" are left as they are (of triangles under them that are separated for
/// another decal, SolvedJob::former tells where they were: what still shows those texels shows the decal);
/// one whose it is "error" fails.
///
/// In the model, such triangles become a primitive of the same mesh with a material of its own; all textures
/// of the material are resampled into an atlas, so that what the decal does not cover looks as before, and
/// stored as `encoding` says, unless a decal is baked into them afterwards. A decal for all instances changes
/// the mesh that they share. The job then is about the new model: its decals' surfaces refer to the new
/// parts. Without a conflict nothing changes.
///
/// Tangent frames that the new coordinates would turn are turned in normal maps; where the material has an
/// anisotropy (KHR_materials_anisotropy), the old ones are written instead.
///
/// Adds warnings to the decals: uv_conflict for one that shares coordinates too coarse for it,
/// uv_slot_not_resampled, uv_atlas_coarser, anisotropy_turns. Errors:
/// uvs_missing, uvs_shared; those of load_model_image, encode_texture and lay_out_uvs.
Result<SeparatedUvs> separate_uvs(SolvedJob& job, const TextureEncoding& encoding = {});

}  // namespace applique
