#include "unwrap.h"

#include <map>
#include <utility>

#include "bake_plan.h"
#include "texture_slots.h"

namespace applique {
namespace {

/// The triangles' corners in a texture, through a mapping; none where a part has no such coordinates.
std::vector<std::array<Texel, 3>> corners_in(const Image& image, const UvMapping& mapping,
                                             const SolvedJob& job,
                                             const std::vector<SeparatedTriangle>& triangles) {
  std::map<std::uint32_t, std::vector<std::array<double, 2>>> uvs;
  std::vector<std::array<Texel, 3>> list;
  for (const SeparatedTriangle& t : triangles) {
    const ModelPart& part = job.model.parts[t.part];
    const auto [of_part, fresh] = uvs.try_emplace(t.part);
    if (fresh) of_part->second = uvs_through(job.model, part, mapping);
    if (of_part->second.empty()) return {};
    std::array<Texel, 3> corners = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& uv = of_part->second[part.triangles[t.triangle][k]];
      corners[k] = {uv[0] * image.width, uv[1] * image.height};
    }
    list.push_back(corners);
  }
  return list;
}

}  // namespace

bool unwraps_unseen(const SolvedJob& job, const TextureGroup& group,
                    std::vector<SeparatedTriangle> triangles) {
  if (!group.material) return true;
  LayoutRequest request;
  request.triangles = std::move(triangles);
  for (SeparatedTriangle& t : request.triangles) t.unwrap = true;
  request.texture = group.texture;
  if (!group.has_texture) request.created_size = job.job.texture_size;
  const auto layout = lay_out_uvs(job, request);
  if (!layout) return false;
  const Document& document = job.model.document;
  const auto& material = document.json["materials"][*group.material];
  const UvMapping base = read_uv_mapping(material);
  for (const TextureSlots& slot : find_texture_slots(material)) {
    if (slot.texture >= count_of(document, "textures")) continue;  // Of an extension that is not checked.
    const auto& texture = document.json["textures"][slot.texture];
    const auto index = image_of_texture(texture);
    const auto image = index ? load_document_image(document, *index) : Result<Image>(Image());
    if (!image || image->rgba.empty()) continue;
    Resampling resampling;
    resampling.old_corners = corners_in(*image, slot.mapping, job, request.triangles);
    if (resampling.old_corners.empty()) continue;
    resampling.texture = &*image;
    const auto [wrap_u, wrap_v] = read_wrap_modes(document, texture);
    resampling.wrap_u = wrap_u;
    resampling.wrap_v = wrap_v;
    resampling.nearest = magnifies_nearest(document, texture);
    resampling.content = slot.content;
    resampling.layout = &*layout;
    if (slot.mapping == base)
      resampling.reference = {static_cast<double>(request.texture[0]) / image->width,
                              static_cast<double>(request.texture[1]) / image->height};
    resampling.size = slot.name == "baseColorTexture" ? layout->size : resampled_size(resampling);
    if (!keeps_look(resampling)) return false;
  }
  return true;
}

}  // namespace applique
