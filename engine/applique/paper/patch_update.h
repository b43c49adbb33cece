#pragma once

#include <unordered_map>
#include <vector>

#include "applique/paper/region_walk.h"
#include "applique/region/region.h"

namespace applique {

/// Removal and insertion between two embeddings (§5.2 of the paper). Gluing zips, which is the precise form
/// of the paper's merging (Fig. 18; E18 of the design), and only what keeps a disc is removed (E17).
///
/// New vertices get their place in `plane` by continuing the map of the triangle they are glued to. Two
/// guards that the paper lacks end the growth (§2.8 of the design): no surface face is covered more often
/// than `cover_limit`, and none is removed again once it has been removed as often.
class PatchUpdate {
 public:
  PatchUpdate(ImmersedDisc& disc, std::vector<PatchVertexId>& features, const Region& region,
              std::uint32_t cover_limit);

  /// Steps (c) and (d) of Fig. 19: triangles with no corner in S. Those that meet the region all the same
  /// stay: the paper would leave its corners uncovered where they are smaller than a triangle. Returns how
  /// many.
  std::size_t remove_outside(const LocatedPatch& located);
  /// Step (e), Fig. 17(a): a strip along the boundary, all triangles at its vertices in S, and, as above,
  /// those across an edge that meets the region. Returns how many.
  std::size_t add_strip(const LocatedPatch& located, std::vector<Vec2>& plane);
  /// Step (f), Fig. 17(b): where an inner edge has both ends on the boundary, the triangles at its ends in S.
  /// Returns how many.
  std::size_t widen_bridges(const LocatedPatch& located, std::vector<Vec2>& plane);
  /// Drops dead ids; `plane` and the features follow.
  void compact(std::vector<Vec2>& plane);

 private:
  void complete_fans(const std::vector<PatchVertexId>& vertices);
  void place_new(std::size_t known, std::vector<Vec2>& plane) const;

  ImmersedDisc& disc_;
  std::vector<PatchVertexId>& features_;
  const Region& region_;
  std::uint32_t cover_limit_;
  std::unordered_map<FaceId, std::uint32_t> removed_;
};

}  // namespace applique
