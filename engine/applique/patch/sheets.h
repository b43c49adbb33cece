#pragma once

#include <cstdint>

#include "applique/patch/depth.h"
#include "applique/patch/patch.h"

namespace applique {

/// The rank of each patch face among those over its surface face, 0 = bottom: by depth, the larger on top,
/// then by order, then the later face. Painting rank after rank paints every place from below to above. A
/// face over a bridged hole has rank 0.
IdVector<PatchFaceId, std::uint32_t> rank_sheets(const Patch& patch, const FaceDepths& depths);

/// How a patch lies over itself.
struct SheetOrder {
  std::uint32_t sheets = 1;  ///< How often a surface face is covered at most.
  IdVector<PatchFaceId, double> depth;
  IdVector<PatchFaceId, std::uint32_t> sheet;
};
/// The patch's sheets, ordered by the features' depths; depths are spread only where there are several, else
/// all 0.
SheetOrder order_sheets(const Patch& patch, const IdVector<PatchVertexId, Vec2>& image,
                        std::span<const DepthFeature> features, std::span<const FeaturePair> tree);

}  // namespace applique
