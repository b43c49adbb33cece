#include "uv_conflict.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "edit.h"
#include "uv_coverage.h"
#include "uv_raster.h"

namespace applique {
namespace {

Result<std::array<int, 2>> texture_size(const Model& model, std::size_t image) {
  APPLIQUE_TRY(const auto bytes, read_image_bytes(model.document, image));
  return image_size(bytes, fmt::format("'{}', image {}", model.document.name, image));
}

/// All triangles of the group in its texture, or in a coarser one if they go round it very often.
UvCoverage cover(const SolvedJob& job, const TextureGroup& group) {
  constexpr double most_texels = 1 << 27;
  double texels = 0;
  for (const std::uint32_t p : group.parts) {
    const ModelPart& part = job.model.parts[p];
    if (part.uvs.empty()) continue;
    for (std::uint32_t t = 0; t < part.triangles.size(); ++t)
      texels += 0.5 * std::abs(doubled_area(texels_of(job, {p, t, 0, {}}, group.texture)));
  }
  const double scale = std::min(1.0, std::sqrt(most_texels / std::max(texels, 1.0)));
  const auto side = [&](int full) { return std::max(1, static_cast<int>(scale * full)); };
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  if (group.material) {
    wrap_u = job.model.materials[*group.material].wrap_u;
    wrap_v = job.model.materials[*group.material].wrap_v;
  }
  UvCoverage coverage(side(group.texture[0]), side(group.texture[1]), wrap_u, wrap_v);
  for (const std::uint32_t p : group.parts) {
    const ModelPart& part = job.model.parts[p];
    if (part.uvs.empty()) continue;
    for (const auto& t : part.triangles) coverage.add({part.uvs[t[0]], part.uvs[t[1]], part.uvs[t[2]]});
  }
  return coverage;
}

}  // namespace

std::vector<SeparatedTriangle> touched_triangles(const SolvedJob& job, std::size_t decal_index) {
  const SolvedDecal& decal = job.decals[decal_index];
  const DecalMap& map = decal.map;
  std::map<std::pair<std::uint32_t, std::uint32_t>, PatchFaceId> lowest;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size())) {
    const FaceId face = map.patch.faces[f].mesh_face;
    if (map.textured[f] == 0 || !face.valid()) continue;
    const auto& source = decal.surface->source(face);
    const auto [place, fresh] = lowest.try_emplace({source.part, source.triangle}, f);
    if (!fresh && map.sheet[f] < map.sheet[place->second]) place->second = f;
  }
  std::vector<SeparatedTriangle> list;
  for (const auto& [source, face] : lowest) list.push_back({source.first, source.second, decal_index, face});
  return list;
}

Result<std::vector<TextureGroup>> find_texture_groups(const SolvedJob& job) {
  std::set<std::uint32_t> touched;
  for (std::size_t d = 0; d < job.decals.size(); ++d)
    if (job.decals[d].job.output == DecalOutput::bake)
      for (const SeparatedTriangle& t : touched_triangles(job, d)) touched.insert(t.part);
  std::vector<PartKey> keys;
  for (const std::uint32_t p : touched) {
    const ModelPart& part = job.model.parts[p];
    keys.push_back({part.node, part.mesh, part.primitive});
  }
  const std::vector<std::size_t> ranks = instance_ranks(keys);
  std::map<std::pair<std::optional<std::size_t>, std::size_t>, TextureGroup> groups;
  std::size_t i = 0;
  for (const std::uint32_t p : touched) {
    const auto material = job.model.parts[p].material;
    TextureGroup& group = groups[{material, ranks[i++]}];
    group.material = material;
    group.parts.push_back(p);
  }
  std::vector<TextureGroup> list;
  for (auto& [key, group] : groups) {
    group.texture = {job.job.texture_size, job.job.texture_size};
    const auto image = group.material ? job.model.materials[*group.material].image : std::nullopt;
    group.has_texture = image.has_value();
    if (image) {
      APPLIQUE_TRY(group.texture, texture_size(job.model, *image));
    }
    list.push_back(std::move(group));
  }
  return list;
}

bool UvState::conflicts() const {
  // Where triangles meet, rounding may give a texel to both; some slivers are in many models.
  constexpr double few_texels = 1e-3;
  constexpr double few_pixels = 1e-2;
  return without_uvs ||
         static_cast<double>(shared_texels) > few_texels * static_cast<double>(covered_texels) ||
         lost_pixels > few_pixels * pixels;
}

std::vector<UvState> find_uv_states(const SolvedJob& job, const TextureGroup& group) {
  const UvCoverage coverage = cover(job, group);
  std::vector<UvState> states(job.decals.size());
  for (std::size_t d = 0; d < job.decals.size(); ++d) {
    if (job.decals[d].job.output != DecalOutput::bake) continue;
    UvState& state = states[d];
    for (const SeparatedTriangle& t : touched_triangles(job, d)) {
      if (!std::binary_search(group.parts.begin(), group.parts.end(), t.part)) continue;
      state.triangles.push_back(t);
      const ModelPart& part = job.model.parts[t.part];
      if (part.uvs.empty()) {
        state.without_uvs = true;
        continue;
      }
      const auto& corners = part.triangles[t.triangle];
      const auto count = coverage.under({part.uvs[corners[0]], part.uvs[corners[1]], part.uvs[corners[2]]});
      state.covered_texels += count.covered;
      state.shared_texels += count.shared;
      const double pixels = pixels_on(job, t);
      state.pixels += pixels;
      if (!has_texture_space(job, t, group.texture)) state.lost_pixels += pixels;
    }
  }
  return states;
}

}  // namespace applique
