#include "bake_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "edit.h"

namespace applique {
namespace {

/// Calls `visit(face, source)` for each patch face that shows some of the image.
template <class Visit>
void for_textured_faces(const SolvedDecal& decal, const Visit& visit) {
  const DecalMap& map = decal.map;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size())) {
    const FaceId face = map.patch.faces[f].mesh_face;
    if (map.textured[f] != 0 && face.valid()) visit(f, decal.surface->source(face));
  }
}

/// The decals on each part that some decal is baked into.
std::map<std::uint32_t, std::set<std::size_t>> find_touched_parts(const SolvedJob& job) {
  std::map<std::uint32_t, std::set<std::size_t>> touched;
  for (std::size_t d = 0; d < job.decals.size(); ++d)
    if (job.decals[d].job.output == DecalOutput::bake)
      for_textured_faces(job.decals[d],
                         [&](PatchFaceId, const auto& source) { touched[source.part].insert(d); });
  return touched;
}

Result<void> check_uvs(const SolvedJob& job, std::uint32_t part_index, std::size_t decal) {
  const ModelPart& part = job.model.parts[part_index];
  if (!part.uvs.empty()) return {};
  const auto& mesh = job.model.document.json.at("meshes").at(part.mesh);
  const std::string name = mesh.value("name", std::string());
  return fail(
      ErrorCode::uvs_missing,
      fmt::format(
          "decal '{}': mesh {}{}, primitive {}, has no texture coordinates to bake into; give the decal "
          "\"uv_conflict\": \"separate\", or \"output\": \"overlay\"",
          job.decals[decal].job.name, part.mesh, name.empty() ? "" : fmt::format(" '{}'", name),
          part.primitive));
}

double area_of(const Texel& a, const Texel& b, const Texel& c) {
  return 0.5 * std::abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

/// Encodes a linear colour as the image stores it.
std::uint16_t stored(double value) {
  return static_cast<std::uint16_t>(257 * std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

}  // namespace

Result<std::vector<BakeTarget>> plan_bake(const SolvedJob& job, Document& document) {
  const auto touched = find_touched_parts(job);
  std::vector<PartKey> keys;
  for (const auto& [index, decals] : touched) {
    APPLIQUE_CHECK(check_uvs(job, index, *decals.begin()));
    const ModelPart& part = job.model.parts[index];
    keys.push_back({part.node, part.mesh, part.primitive});
  }
  const std::vector<std::size_t> isolated = isolate_materials(document, keys);

  std::map<std::size_t, BakeTarget> targets;
  std::size_t i = 0;
  for (const auto& [index, decals] : touched) {
    BakeTarget& target = targets[isolated[i]];
    target.isolated = isolated[i++];
    target.material = job.model.parts[index].material;
    target.parts.push_back(index);
    target.decals.insert(target.decals.end(), decals.begin(), decals.end());
  }
  std::vector<BakeTarget> list;
  for (auto& [material, target] : targets) {
    std::sort(target.decals.begin(), target.decals.end());
    target.decals.erase(std::unique(target.decals.begin(), target.decals.end()), target.decals.end());
    list.push_back(std::move(target));
  }
  return list;
}

bool has_texture(const Model& model, const BakeTarget& target) {
  return target.material && model.materials[*target.material].image.has_value();
}

Result<Image> initial_texture(const SolvedJob& job, const BakeTarget& target) {
  if (has_texture(job.model, target))
    return load_model_image(job.model, *job.model.materials[*target.material].image);
  const auto factor = target.material ? job.model.materials[*target.material].base_colour_factor
                                      : std::array<double, 4>{1, 1, 1, 1};
  const int size = job.job.texture_size;
  Image image = make_image(size, size,
                           {stored(linear_to_srgb(factor[0])), stored(linear_to_srgb(factor[1])),
                            stored(linear_to_srgb(factor[2])), stored(factor[3])});
  if (factor[3] == 1) image.channels = 3;
  return image;
}

Transfer lay_out_transfer(const SolvedJob& job, const BakeTarget& target, std::size_t decal_index, int width,
                          int height) {
  const SolvedDecal& decal = job.decals[decal_index];
  const DecalMap& map = decal.map;
  Transfer transfer;
  transfer.warp = &map.warp;
  transfer.opacity = decal.job.opacity;
  transfer.blend = decal.job.blend;
  if (target.material) {
    const ModelMaterial& material = job.model.materials[*target.material];
    transfer.wrap_u = material.wrap_u;
    transfer.wrap_v = material.wrap_v;
    transfer.opaque = material.alpha_mode == "OPAQUE";
  }

  const auto texel_corners = [&](std::uint32_t part_index, std::uint32_t triangle) {
    const ModelPart& part = job.model.parts[part_index];
    std::array<Texel, 3> texel = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& uv = part.uvs[part.triangles[triangle][k]];
      texel[k] = {uv[0] * width, uv[1] * height};
    }
    return texel;
  };

  std::map<std::uint32_t, std::vector<char>> own;  // by part: the triangles that carry the decal
  for (const std::uint32_t part : target.parts) own[part].resize(job.model.parts[part].triangles.size(), 0);
  for_textured_faces(decal, [&](PatchFaceId f, const ModelSurface::Source& source) {
    const auto part = own.find(source.part);
    if (part == own.end()) return;
    part->second[source.triangle] = 1;
    TransferFace face;
    face.texel = texel_corners(source.part, source.triangle);
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchVertexId vertex = map.patch.faces[f].vertices[k];
      face.plane[k] = map.plane[vertex];
      face.image[k] = map.image[vertex];
      if (map.groups == 1) continue;
      const auto influence = map.influence.begin() + std::ptrdiff_t{vertex.value} * map.groups;
      transfer.influence.insert(transfer.influence.end(), influence, influence + map.groups);
    }
    face.linear = map.linear[f] != 0;
    face.sheet = map.sheet[f];
    transfer.faces.push_back(face);
  });
  for (const auto& [part, triangles] : own)
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      if (triangles[t] == 0) transfer.foreign.push_back(texel_corners(part, t));
  return transfer;
}

std::optional<TexelDensity> texel_density(const SolvedDecal& decal,
                                          const std::vector<const Transfer*>& transfers) {
  const double pixels_per_unit = decal.region.frame().pixels_per_unit();
  double texels = 0;
  double pixels = 0;
  for (const Transfer* transfer : transfers)
    for (const TransferFace& face : transfer->faces) {
      texels += area_of(face.texel[0], face.texel[1], face.texel[2]);
      pixels += 0.5 * std::abs(cross(face.image[1] - face.image[0], face.image[2] - face.image[0])) *
                pixels_per_unit * pixels_per_unit;
    }
  double surface = 0;
  for_textured_faces(decal, [&](PatchFaceId f, const auto&) {
    const auto corners = decal.surface->mesh.corners(decal.map.patch.faces[f].mesh_face);
    surface += 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  });
  if (texels <= 0 || pixels <= 0 || surface <= 0) return std::nullopt;
  return TexelDensity{std::sqrt(texels / surface), std::sqrt(texels / pixels)};
}

}  // namespace applique
