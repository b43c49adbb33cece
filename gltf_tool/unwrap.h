#pragma once

#include <vector>

#include "uv_conflict.h"
#include "uv_layout.h"

namespace applique {

/// Whether a decal's triangles of a group can be laid out as the decal lies on them, by themselves, with
/// every texture of the material resampled, and look as they do now, to 2/255 where the textures are
/// magnified. A texture that cannot be read does not count: it keeps its coordinates.
bool unwraps_unseen(const SolvedJob& job, const TextureGroup& group,
                    std::vector<SeparatedTriangle> triangles);

}  // namespace applique
