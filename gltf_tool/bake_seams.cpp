#include "bake_seams.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "decal_layers.h"
#include "instances.h"
#include "tangents.h"

namespace applique {
namespace {

/// By surface face, the sheet that is on top; empty where there is only one.
std::map<FaceId, std::uint32_t> top_sheets(const DecalMap& map) {
  std::map<FaceId, std::uint32_t> top;
  if (map.sheets == 1) return top;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size())) {
    if (map.textured[f] == 0) continue;
    std::uint32_t& sheet = top[map.patch.faces[f].mesh_face];
    sheet = std::max(sheet, map.sheet[f]);
  }
  return top;
}

/// A normal map's +x and +y at the ends of a side of a triangle, in the tangent plane there: x along the
/// side.
std::array<std::array<Vec2, 2>, 2> axes_at(const ModelPart& part, std::size_t triangle,
                                           const std::array<Tangent, 3>& frames,
                                           const std::array<std::array<double, 3>, 2>& ends) {
  const auto place = [&](std::size_t end) {
    return blend(ends[end], [&](std::size_t k) { return part.positions[part.triangles[triangle][k]]; });
  };
  const Vec3 side = place(1) - place(0);
  std::array<std::array<Vec2, 2>, 2> axes = {};
  for (std::size_t end = 0; end < 2; ++end) {
    const auto [tangent, bitangent, normal] = frame_inside(part, triangle, frames, ends[end]);
    const Vec3 along = (side - normal.dot(side) * normal).normalized();
    const Vec3 across = normal.cross(along);
    axes[end] = {Vec2(tangent.dot(along), tangent.dot(across)),
                 Vec2(bitangent.dot(along), bitangent.dot(across))};
  }
  return axes;
}

/// A decal's faces as the targets of one slot show them.
class ShownFaces {
 public:
  ShownFaces(const SolvedJob& job, const SolvedDecal& decal, std::span<const SizedTarget> targets)
      : job_(job), decal_(decal), targets_(targets), top_(top_sheets(decal.map)) {
    for (std::uint32_t i = 0; i < targets.size(); ++i)
      for (const std::uint32_t part : targets[i].target->parts) add_part(part, i);
    if (decal.job.instance != Instance::all) return;
    for (std::uint32_t i = 0; i < targets.size(); ++i)
      for (std::uint32_t part = 0; part < job.model.parts.size(); ++part)
        if (part_that_shows(job.model, decal.job, targets[i].target->parts, part)) add_part(part, i);
  }

  /// The face's side with the given vertices, in that order; none where it shows nothing.
  [[nodiscard]] std::optional<Seam::Side> side(PatchFaceId f,
                                               const std::array<PatchVertexId, 2>& ends) const {
    const DecalMap& map = decal_.map;
    const PatchFace& face = map.patch.faces[f];
    if (map.textured[f] == 0 || !face.mesh_face.valid()) return std::nullopt;
    if (!top_.empty() && top_.at(face.mesh_face) != map.sheet[f]) return std::nullopt;
    const auto& source = decal_.surface->source(face.mesh_face);
    const auto found = target_of_.find(source.part);
    if (found == target_of_.end()) return std::nullopt;
    const SizedTarget& target = targets_[found->second];
    const auto& triangle = job_.model.parts[source.part].triangles[source.triangle];
    const auto& uvs = uvs_.at(source.part);
    std::array<Texel, 3> texels = {};
    for (std::size_t k = 0; k < 3; ++k)
      texels[k] = {uvs[triangle[k]][0] * target.width, uvs[triangle[k]][1] * target.height};
    const FaceCorners& inside = decal_.surface->corners_in_source(face.mesh_face);
    texels = texels_inside(texels, inside);
    Seam::Side side{found->second, {}, {}};
    std::array<std::array<double, 3>, 2> weights = {};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto end =
          static_cast<std::size_t>(std::find(ends.begin(), ends.end(), face.vertices[corner]) - ends.begin());
      (end == ends.size() ? side.apex : side.ends[end]) = texels[corner];
      if (end < ends.size()) weights[end] = inside[corner];
    }
    if (const auto frames = frames_.find(source.part); frames != frames_.end())
      side.axes =
          axes_at(job_.model.parts[source.part], source.triangle, frames->second[source.triangle], weights);
    return side;
  }

 private:
  void add_part(std::uint32_t part, std::uint32_t target) {
    if (!target_of_.try_emplace(part, target).second) return;
    const MaterialSlot slot = targets_[target].target->slot;
    uvs_[part] = slot_uvs(job_.model, job_.model.parts[part], slot);
    if (encoding_of(slot) == Encoding::normal)
      frames_[part] = tangent_frames(job_.model.parts[part], uvs_[part]);
  }

  const SolvedJob& job_;
  const SolvedDecal& decal_;
  std::span<const SizedTarget> targets_;
  std::map<FaceId, std::uint32_t> top_;
  std::map<std::uint32_t, std::uint32_t> target_of_;  // By part.
  std::map<std::uint32_t, std::vector<std::array<double, 2>>> uvs_;
  std::map<std::uint32_t, std::vector<std::array<Tangent, 3>>> frames_;  // Of normal maps.
};

bool coincide(const Seam::Side& a, const Seam::Side& b) {
  constexpr double tolerance = 1e-3;  // texels
  if (a.texture != b.texture) return false;
  for (std::size_t k = 0; k < 2; ++k)
    if (std::hypot(a.ends[k][0] - b.ends[k][0], a.ends[k][1] - b.ends[k][1]) > tolerance) return false;
  return true;
}

}  // namespace

std::vector<Seam> find_seams(const SolvedJob& job, std::span<const SizedTarget> targets) {
  std::set<std::size_t> decals;
  for (const SizedTarget& target : targets)
    for (const BakeShare& share : target.target->shares) decals.insert(share.decal);
  std::vector<Seam> seams;
  for (const std::size_t d : decals) {
    const SolvedDecal& decal = job.decals[d];
    const ShownFaces shown(job, decal, targets);
    for (const PatchFaceId f : ids<PatchFaceId>(decal.map.patch.faces.size())) {
      const PatchFace& face = decal.map.patch.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        const PatchFaceId across = face.neighbours[k];
        if (!across.valid() || across < f) continue;
        const std::array<PatchVertexId, 2> ends = {face.vertices[(k + 1) % 3], face.vertices[(k + 2) % 3]};
        const auto here = shown.side(f, ends), there = shown.side(across, ends);
        if (here && there && !coincide(*here, *there)) seams.push_back({{*here, *there}});
      }
    }
  }
  return seams;
}

}  // namespace applique
