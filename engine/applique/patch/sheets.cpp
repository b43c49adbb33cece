#include "applique/patch/sheets.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <utility>
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

SheetOrder order_sheets(const Patch& patch, const IdVector<PatchVertexId, Vec2>& image,
                        std::span<const DepthFeature> features, std::span<const FeaturePair> tree) {
  SheetOrder order;
  std::unordered_map<FaceId, std::uint32_t> cover;
  for (const PatchFace& face : patch.faces)
    if (face.mesh_face.valid()) order.sheets = std::max(order.sheets, ++cover[face.mesh_face]);
  order.depth.resize(patch.faces.size(), 0);
  order.sheet.resize(patch.faces.size(), 0);
  if (order.sheets == 1) return order;
  FaceDepths depths = spread_depths(patch, image, features, tree);
  order.sheet = rank_sheets(patch, depths);
  order.depth = std::move(depths.depth);
  return order;
}

}  // namespace applique
