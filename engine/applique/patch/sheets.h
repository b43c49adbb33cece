#pragma once

#include <cstdint>

#include "applique/patch/patch.h"

namespace applique {

/// The rank of each patch face among those over its surface face, 0 = bottom: by `depth`, the larger on top,
/// of equal ones the later face. Painting rank after rank paints every place from below to above. A face
/// over a bridged hole has rank 0.
IdVector<PatchFaceId, std::uint32_t> rank_sheets(const Patch& patch,
                                                 const IdVector<PatchFaceId, double>& depth);

}  // namespace applique
