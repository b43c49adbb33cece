#pragma once

#include <unordered_map>
#include <vector>

#include "applique/patch/immersed_disc.h"

namespace applique {

/// Removal and insertion between two embeddings (§5.2 of the paper). Gluing zips, which is the precise form
/// of the paper's merging (Fig. 18; E18 of the design), and only what keeps a disc is removed (E17).
///
/// New vertices get their place in `plane` by continuing the map of the triangle they are glued to. Two
/// guards that the paper lacks end the growth (§2.8 of the design): no surface face is covered more often
/// than `cover_limit`, and none is removed again once it has been removed as often.
class PatchUpdate {
 public:
  PatchUpdate(ImmersedDisc& disc, std::vector<PatchVertexId>& features, std::uint32_t cover_limit);

  using Inside = IdVector<PatchVertexId, char>;
  /// Steps (c) and (d) of Fig. 19: triangles with no corner in S. Returns how many.
  std::size_t remove_outside(const Inside& inside);
  /// Step (e), Fig. 17(a): a strip along the boundary, all triangles at its vertices in S. Returns how many.
  std::size_t add_strip(const Inside& inside, std::vector<Vec2>& plane);
  /// Step (f), Fig. 17(b): where an inner edge has both ends on the boundary, the triangles at its ends in S.
  /// Returns how many.
  std::size_t widen_bridges(const Inside& inside, std::vector<Vec2>& plane);
  /// Drops dead ids; `plane` and the features follow.
  void compact(std::vector<Vec2>& plane);

 private:
  std::size_t complete_fans(const std::vector<PatchVertexId>& vertices, std::vector<Vec2>& plane);

  ImmersedDisc& disc_;
  std::vector<PatchVertexId>& features_;
  std::uint32_t cover_limit_;
  std::unordered_map<FaceId, std::uint32_t> removed_;
};

}  // namespace applique
