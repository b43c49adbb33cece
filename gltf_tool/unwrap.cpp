#include "unwrap.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bake_plan.h"
#include "uv_resample.h"

namespace applique {

namespace {

/// Whether two sides of an edge lie side by side, or whole texels apart, which a filter does not see.
bool in_step(const std::array<Texel, 2>& here, const std::array<Texel, 2>& there) {
  constexpr double tolerance = 1e-3;  // texels
  for (std::size_t c = 0; c < 2; ++c) {
    const double first = here[0][c] - there[0][c];
    const double second = here[1][c] - there[1][c];
    if (std::abs(first - std::round(first)) > tolerance || std::abs(second - first) > tolerance) return false;
  }
  return true;
}

/// The pixels along which the decal crosses seams in a layout of all of its triangles.
double seam_pixels_in(const SolvedJob& job, const LayoutRequest& request, const UvLayout& layout) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> index;
  for (std::size_t i = 0; i < request.triangles.size(); ++i)
    index[{request.triangles[i].part, request.triangles[i].triangle}] = i;
  return seam_pixels(job, request.triangles.front().decal,
                     [&](std::uint32_t part, std::uint32_t triangle) -> std::optional<std::array<Texel, 3>> {
                       const auto found = index.find({part, triangle});
                       if (found == index.end()) return std::nullopt;
                       auto corners = layout.corners[found->second];
                       for (Texel& corner : corners)
                         for (double& x : corner) x *= layout.fineness;
                       return corners;
                     });
}

}  // namespace

double seam_pixels(const SolvedJob& job, std::size_t decal_index, const TexelsOf& texels_of) {
  const SolvedDecal& decal = job.decals[decal_index];
  const DecalMap& map = decal.map;
  const auto corners_of = [&](PatchFaceId f) -> std::optional<std::array<Texel, 3>> {
    const FaceId face = map.patch.faces[f].mesh_face;
    if (map.textured[f] == 0 || !face.valid()) return std::nullopt;
    const auto& source = decal.surface->source(face);
    const auto corners = texels_of(source.part, source.triangle);
    if (!corners) return std::nullopt;
    return texels_inside(*corners, decal.surface->corners_in_source(face));
  };
  double pixels = 0;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size())) {
    const auto here = corners_of(f);
    if (!here) continue;
    const PatchFace& face = map.patch.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchFaceId across = face.neighbours[k];
      const auto there = across.valid() && f < across ? corners_of(across) : std::nullopt;
      if (!there) continue;
      const auto& vertices = map.patch.faces[across].vertices;
      std::array<PatchVertexId, 2> ends = {};
      std::array<Texel, 2> on_here = {};
      std::array<Texel, 2> on_there = {};
      for (std::size_t e = 0; e < 2; ++e) {
        const std::size_t end = (k + 1 + e) % 3;
        ends[e] = face.vertices[end];
        on_here[e] = (*here)[end];
        on_there[e] = (*there)[static_cast<std::size_t>(std::find(vertices.begin(), vertices.end(), ends[e]) -
                                                        vertices.begin())];
      }
      if (!in_step(on_here, on_there)) pixels += std::abs(map.image[ends[1]] - map.image[ends[0]]);
    }
  }
  return decal.region.frame().pixels_per_unit() * pixels;
}

bool unwraps_unseen(const SolvedJob& job, const TextureGroup& group, std::vector<SeparatedTriangle> triangles,
                    double most_seams) {
  LayoutRequest request;
  request.triangles = std::move(triangles);
  for (SeparatedTriangle& t : request.triangles) t.unwrap = true;
  request.texture = group.texture;
  if (!group.has_texture) request.created_size = job.job.texture_size;
  const auto layout = lay_out_uvs(job, request);
  if (!layout || seam_pixels_in(job, request, *layout) > most_seams) return false;
  if (!group.material) return true;
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
