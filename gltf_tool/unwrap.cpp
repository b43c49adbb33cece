#include "unwrap.h"

#include <utility>

#include "bake_plan.h"
#include "uv_resample.h"

namespace applique {

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
    const auto index = image_of_texture(document.json["textures"][slot.texture]);
    const auto image = index ? load_document_image(document, *index) : Result<Image>(Image());
    if (!image || image->rgba.empty()) continue;
    std::vector<std::array<Texel, 3>> old_corners;
    for (const auto& texels :
         texels_through(job, request.triangles, slot.mapping, {image->width, image->height}))
      if (texels) old_corners.push_back(*texels);
    if (old_corners.size() < request.triangles.size()) continue;
    if (!keeps_look(
            plan_resampling(document, slot, *image, std::move(old_corners), *layout, request.texture, base)))
      return false;
  }
  return true;
}

}  // namespace applique
