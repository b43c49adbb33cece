#pragma once

#include <cstdint>
#include <vector>

#include "applique/base/error.h"

#include "solve_job.h"

namespace applique {

/// Gives triangles under the job's baked decals texture space of their own where they have none, or share
/// it: where other triangles of the model show the same texels (mirrored halves, tiles, stacked islands),
/// where their texture coordinates are too coarse for a decal, and where there are none at all. Decals whose
/// "uv_conflict" is "share" are left as they are; one whose it is "error" fails.
///
/// In the model, such triangles become a primitive of the same mesh with a material of its own; all textures
/// of the material are resampled into an atlas, so that what the decal does not cover looks as before. The
/// job then is about the new model: its decals' surfaces refer to the new parts. Without a conflict nothing
/// changes.
///
/// Returns the parts of the new model that consist of separated triangles, ascending. Adds warnings to the
/// decals: uv_slot_not_resampled, uv_atlas_coarser. Errors: uvs_shared; those of load_model_image and
/// lay_out_uvs.
Result<std::vector<std::uint32_t>> separate_uvs(SolvedJob& job);

}  // namespace applique
