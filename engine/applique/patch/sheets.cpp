#include "applique/patch/sheets.h"

#include <algorithm>
#include <tuple>
#include <vector>

namespace applique {

IdVector<PatchFaceId, std::uint32_t> rank_sheets(const Patch& patch, const FaceDepths& depths) {
  std::vector<PatchFaceId> order;
  for (const PatchFaceId q : ids<PatchFaceId>(patch.faces.size()))
    if (patch.faces[q].mesh_face.valid()) order.push_back(q);
  std::sort(order.begin(), order.end(), [&](PatchFaceId a, PatchFaceId b) {
    return std::tuple(patch.faces[a].mesh_face, depths.depth[a], depths.order[a], a) <
           std::tuple(patch.faces[b].mesh_face, depths.depth[b], depths.order[b], b);
  });
  IdVector<PatchFaceId, std::uint32_t> sheet(patch.faces.size(), 0);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (patch.faces[order[i]].mesh_face == patch.faces[order[i - 1]].mesh_face)
      sheet[order[i]] = sheet[order[i - 1]] + 1;
  return sheet;
}

}  // namespace applique
