#pragma once

#include <cstdint>

#include "applique/patch/depth.h"
#include "applique/patch/patch.h"

namespace applique {

/// The rank of each patch face among those over its surface face, 0 = bottom: by depth, the larger on top, then
/// by order, then the later face. Painting rank after rank paints every place from below to above. A face
/// over a bridged hole has rank 0.
IdVector<PatchFaceId, std::uint32_t> rank_sheets(const Patch& patch, const FaceDepths& depths);

}  // namespace applique
