#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "applique/patch/immersed_disc.h"
#include "applique/region/triangulation.h"

namespace applique {

/// The image region carried to the plane of the embedding: a triangulation of it, and where the forward warp
/// puts the points. It may overlap itself: all that is asked of it is asked from a triangle on.
struct WarpedRegion {
  const RegionTriangulation* image;
  std::vector<Vec2> plane;  ///< By point of the triangulation.
};

/// A patch against the warped region (§5.2.1 of the paper).
struct LocatedPatch {
  IdVector<PatchVertexId, char> inside;  ///< The set S.
  IdVector<PatchVertexId, Vec2> image;   ///< The image point of every vertex, plane units.
  std::vector<std::uint32_t> missed;     ///< The features that are not in S.
};

/// The set S: from the feature `first` on (or from all, when it is none), along the patch's edges as long as
/// they stay in the warped region; each edge is followed from triangle to triangle, so that another sheet of
/// the region, which lies over this one, is not seen. A triangle that the warp has turned over counts as a
/// wall.
///
/// A vertex in S has the image point that the inverse of the piecewise linear warp gives it. One beyond the
/// contour has that of the last triangle's map, continued, on average over the edges that lead to it; farther
/// ones continue the patch's own map, of which `plane` gives the vertices (dead ones included).
LocatedPatch locate_patch(const ImmersedDisc& disc, const std::vector<PatchVertexId>& features,
                          const std::vector<Vec2>& plane, const WarpedRegion& region,
                          std::optional<std::uint32_t> first);

}  // namespace applique
