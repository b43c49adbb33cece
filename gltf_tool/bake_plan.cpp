#include "bake_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "decal_layers.h"
#include "edit.h"
#include "instances.h"
#include "tangents.h"
#include "uv_coverage.h"

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

double area_of(const Texel& a, const Texel& b, const Texel& c) {
  return 0.5 * std::abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

/// Whether two ranges meet, or copies of them by whole periods.
bool meet(const std::array<double, 2>& a, const std::array<double, 2>& b, double period) {
  return std::floor((a[1] - b[0]) / period) >= std::ceil((a[0] - b[1]) / period);
}

/// The texels around a transfer's faces in which other triangles matter to it.
class Surroundings {
 public:
  Surroundings(const Transfer& transfer, int width, int height)
      : wrap_({transfer.wrap_u, transfer.wrap_v}),
        size_({static_cast<double>(width), static_cast<double>(height)}) {
    // A face reaches as far as the gutter, and what lies a gutter further keeps it out; then texel rounding.
    const double margin = 2.0 * transfer.gutter + 4;
    for (const TransferFace& face : transfer.faces)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto range = range_of(face.texel, axis);
        range_[axis][0] = std::min(range_[axis][0], range[0] - margin);
        range_[axis][1] = std::max(range_[axis][1], range[1] + margin);
      }
  }

  [[nodiscard]] bool touch(const std::array<Texel, 3>& triangle) const {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto range = range_of(triangle, axis);
      const bool mirrored = wrap_[axis] == WrapMode::mirror;
      const double period = wrap_[axis] == WrapMode::clamp ? 1e12 : (mirrored ? 2 : 1) * size_[axis];
      if (!meet(range, range_[axis], period) &&
          !(mirrored && meet({-range[1], -range[0]}, range_[axis], period)))
        return false;
    }
    return true;
  }

 private:
  static std::array<double, 2> range_of(const std::array<Texel, 3>& triangle, std::size_t axis) {
    const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    return {low, high};
  }

  std::array<WrapMode, 2> wrap_;
  std::array<double, 2> size_;
  std::array<std::array<double, 2>, 2> range_ = {{{1e9, -1e9}, {1e9, -1e9}}};
};

/// Tells which triangles show for the most part what a transfer's faces do: stacked or mirrored ones.
class Copies {
 public:
  Copies(const Transfer& transfer, int width, int height)
      : size_({static_cast<double>(width), static_cast<double>(height)}),
        coverage_(width, height, transfer.wrap_u, transfer.wrap_v) {
    for (int twice = 0; twice < 2; ++twice)  // So that each texel of a face counts as shared.
      for (const TransferFace& face : transfer.faces) coverage_.add(in_texture(face.texel));
  }

  [[nodiscard]] bool has(const std::array<Texel, 3>& corners) const {
    const UvCoverage::Count count = coverage_.under(in_texture(corners));
    return 2 * count.shared > count.covered;
  }

 private:
  [[nodiscard]] UvCoverage::Triangle in_texture(const std::array<Texel, 3>& texel) const {
    UvCoverage::Triangle uvs = {};
    for (std::size_t k = 0; k < 3; ++k) uvs[k] = {texel[k][0] / size_[0], texel[k][1] / size_[1]};
    return uvs;
  }

  std::array<double, 2> size_;
  UvCoverage coverage_;
};

/// A share of 1 as the image stores it.
std::uint16_t stored(double value) {
  return static_cast<std::uint16_t>(257 * std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

/// A slot of a material as the model has it; of no material at all where the parts had none.
MaterialTexture texture_of(const Model& model, std::optional<std::size_t> material, MaterialSlot slot) {
  if (!material) return {};
  return read_texture(model.document, model.document.json.at("materials").at(*material), slot);
}

MaterialTexture texture_of(const Model& model, const BakeTarget& target) {
  return texture_of(model, target.material, target.slot);
}

Result<void> check_uvs(const SolvedJob& job, const BakeTarget& target) {
  for (const std::uint32_t index : target.parts) {
    const ModelPart& part = job.model.parts[index];
    if (!slot_uvs(job.model, part, target.slot).empty()) continue;
    const auto& mesh = job.model.document.json.at("meshes").at(part.mesh);
    const std::string name = mesh.value("name", std::string());
    return fail(
        ErrorCode::uvs_missing,
        fmt::format(
            "decal '{}': mesh {}{}, primitive {}, has no texture coordinates to bake the {} into; give the "
            "decal \"output\": \"overlay\"",
            job.decals[target.shares.front().decal].job.name, part.mesh,
            name.empty() ? "" : fmt::format(" '{}'", name), part.primitive, name_of(target.slot)));
  }
  return {};
}

/// Tells a face of a normal map how the image lies in the tangent frames of its corners, which are in
/// triangle `index` of the part.
void turn_into_tangent_space(const ModelPart& part, std::size_t index, const FaceCorners& corners,
                             const std::array<Tangent, 3>& frames, const ImageFrame& frame,
                             TransferFace& face) {
  std::array<Vec3, 3> positions;
  for (std::size_t k = 0; k < 3; ++k)
    positions[k] = blend(
        corners[k], [&](std::size_t i) -> const Vec3& { return part.positions[part.triangles[index][i]]; });
  const Vec3 p1 = positions[1] - positions[0], p2 = positions[2] - positions[0];
  const std::array<Pixel, 3> q = {frame.to_pixel(face.image[0]), frame.to_pixel(face.image[1]),
                                  frame.to_pixel(face.image[2])};
  // In the image y goes down, in a normal map up.
  const double x1 = q[1].x - q[0].x, y1 = q[0].y - q[1].y, x2 = q[2].x - q[0].x, y2 = q[0].y - q[2].y;
  const double side = x1 * y2 - x2 * y1 < 0 ? -1 : 1;
  const Vec3 right = side * (y2 * p1 - y1 * p2), up = side * (x1 * p2 - x2 * p1);
  double turn = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [tangent, bitangent, normal] = frame_inside(part, index, frames, corners[k]);
    const Vec2 along(right.dot(tangent), right.dot(bitangent)), across(up.dot(tangent), up.dot(bitangent));
    face.along[k] = std::abs(along) > 0 ? along / std::abs(along) : Vec2(1);
    turn += cross(along, across);
  }
  face.reversed = turn < 0;
}

/// How a part's triangles lie in a slot's texture.
class PartTexture {
 public:
  PartTexture(const Model& model, const ModelPart& part, MaterialSlot slot, const std::array<int, 2>& size)
      : part_(&part), size_(size), uvs_(slot_uvs(model, part, slot)) {
    if (encoding_of(slot) == Encoding::normal) frames_ = tangent_frames(part, uvs_);
  }

  [[nodiscard]] std::array<Texel, 3> corners(std::size_t triangle) const {
    std::array<Texel, 3> texel = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& uv = uvs_[part_->triangles[triangle][k]];
      texel[k] = {uv[0] * size_[0], uv[1] * size_[1]};
    }
    return texel;
  }

  /// Of a normal map.
  void turn(std::size_t triangle, const FaceCorners& inside, const ImageFrame& frame,
            TransferFace& face) const {
    turn_into_tangent_space(*part_, triangle, inside, frames_[triangle], frame, face);
  }

 private:
  const ModelPart* part_;
  std::array<int, 2> size_;
  std::vector<std::array<double, 2>> uvs_;
  std::vector<std::array<Tangent, 3>> frames_;
};

/// The part as it was, with the triangles last that were separated.
ModelPart part_before(const Model& model, const FormerTriangles& former) {
  ModelPart part = model.parts[former.part];
  part.triangles.insert(part.triangles.end(), former.corners.begin(), former.corners.end());
  return part;
}

/// What the factors of a material make of a slot without a texture, as the texture would store it.
std::array<std::uint16_t, 4> factor_value(const Model& model, std::optional<std::size_t> material,
                                          MaterialSlot slot) {
  const auto none = Document::Json::object();
  auto value = read_factors(material ? model.document.json.at("materials").at(*material) : none, slot);
  if (encoding_of(slot) == Encoding::colour)
    for (std::size_t c = 0; c < 3; ++c) value[c] = linear_to_srgb(value[c]);
  return {stored(value[0]), stored(value[1]), stored(value[2]), stored(value[3])};
}

/// Texels of a texture that is made for a slot.
std::array<int, 2> size_of_new(const SolvedJob& job, std::optional<std::size_t> material, MaterialSlot slot) {
  if (slot != MaterialSlot::base_color) {
    if (job.job.resolution) return {*job.job.resolution, *job.job.resolution};
    const auto base = material ? job.model.materials[*material].image : std::nullopt;
    if (base)
      if (const auto size = document_image_size(job.model.document, *base)) return *size;
  }
  return {job.job.texture_size, job.job.texture_size};
}

/// A layer's share in a texture, but for its faces.
BakeTransfer begin_transfer(const SolvedJob& job, const BakeTarget& target, const BakeShare& share) {
  const SolvedDecal& decal = job.decals[share.decal];
  const DecalLayer& layer = decal.job.layers[share.layer];
  BakeTransfer transfer;
  transfer.warp = &decal.map.warp;
  transfer.opacity = decal.job.opacity * layer.opacity;
  transfer.blend = layer.blend;
  transfer.encoding = encoding_of(layer.slot);
  transfer.channels = layer.channels;
  transfer.gutter = job.job.gutter;
  const MaterialTexture texture = texture_of(job.model, target);
  transfer.wrap_u = texture.wrap_u;
  transfer.wrap_v = texture.wrap_v;
  if (target.material && target.slot == MaterialSlot::base_color)
    transfer.opaque = job.model.materials[*target.material].alpha_mode == "OPAQUE";
  return transfer;
}

}  // namespace

std::vector<std::array<double, 2>> slot_uvs(const Model& model, const ModelPart& part, MaterialSlot slot) {
  if (!part.material || slot == MaterialSlot::base_color) return part.uvs;
  return uvs_through(model, part,
                     read_uv_mapping(model.document.json.at("materials").at(*part.material), slot));
}

std::vector<std::array<double, 2>> uvs_through(const Model& model, const ModelPart& part,
                                               const UvMapping& mapping) {
  if (!part.material || mapping == read_uv_mapping(model.document.json.at("materials").at(*part.material)))
    return part.uvs;
  const auto set = part.other_uvs.find(mapping.set);
  if (set == part.other_uvs.end()) return {};
  std::vector<std::array<double, 2>> uvs = set->second;
  for (auto& uv : uvs) uv = mapping.apply(uv);
  return uvs;
}

Result<std::array<int, 2>> slot_texture_size(const SolvedJob& job, std::optional<std::size_t> material,
                                             MaterialSlot slot) {
  const MaterialTexture texture = texture_of(job.model, material, slot);
  if (!texture.image) return size_of_new(job, material, slot);
  APPLIQUE_TRY(const auto bytes, read_image_bytes(job.model.document, *texture.image));
  return image_size(bytes, fmt::format("{}, image {}", job.model.document.name, *texture.image));
}

Result<std::vector<BakeTarget>> plan_bake(const SolvedJob& job, Document& document) {
  const std::vector<TouchedPart> touched = find_touched_parts(job);
  std::vector<PartKey> keys;
  for (const auto& [index, every_node, decals] : touched) {
    const ModelPart& part = job.model.parts[index];
    keys.push_back({part.node, part.mesh, part.primitive, every_node});
  }
  const std::vector<std::size_t> isolated = isolate_materials(document, keys);

  struct Ground {
    BakeTarget target;
    std::set<std::size_t> decals;
    std::map<std::uint32_t, std::set<std::size_t>> decals_by_part;
  };
  std::map<std::size_t, Ground> grounds;  // By material.
  std::size_t i = 0;
  for (const auto& [index, every_node, decals] : touched) {
    Ground& ground = grounds[isolated[i]];
    ground.target.isolated = isolated[i++];
    ground.target.material = job.model.parts[index].material;
    ground.target.parts.push_back(index);
    ground.decals.insert(decals.begin(), decals.end());
    ground.decals_by_part[index] = decals;
  }
  std::vector<BakeTarget> list;
  for (const auto& entry : grounds)
    for (const MaterialSlot slot : all_slots) {
      const Ground& ground = entry.second;
      BakeTarget target = ground.target;
      target.slot = slot;
      for (const std::size_t d : ground.decals)
        for (std::size_t layer = 0; layer < job.decals[d].job.layers.size(); ++layer)
          if (job.decals[d].job.layers[layer].slot == slot) target.shares.push_back({d, layer});
      if (target.shares.empty()) continue;
      // Parts that cannot show the slot are no matter where no decal writes it there.
      std::erase_if(target.parts, [&](std::uint32_t part) {
        const auto& decals = ground.decals_by_part.at(part);
        return slot_uvs(job.model, job.model.parts[part], slot).empty() &&
               std::none_of(target.shares.begin(), target.shares.end(),
                            [&](const BakeShare& share) { return decals.contains(share.decal); });
      });
      APPLIQUE_CHECK(check_uvs(job, target));
      list.push_back(std::move(target));
    }
  return list;
}

bool has_texture(const Model& model, const BakeTarget& target) {
  return texture_of(model, target).image.has_value();
}

Result<Image> initial_texture(const SolvedJob& job, const BakeTarget& target) {
  if (const MaterialTexture texture = texture_of(job.model, target); texture.image)
    return load_model_image(job.model, *texture.image);
  return texture_of_factors(job, target.material, target.slot,
                            size_of_new(job, target.material, target.slot));
}

Image texture_of_factors(const SolvedJob& job, std::optional<std::size_t> material, MaterialSlot slot,
                         const std::array<int, 2>& size) {
  const auto value = factor_value(job.model, material, slot);
  Image image = make_image(size[0], size[1], value);
  if (value[3] == 65535) image.channels = 3;
  return image;
}

BakeTransfer lay_out_transfer(const SolvedJob& job, const BakeTarget& target, const BakeShare& share,
                              int width, int height) {
  const SolvedDecal& decal = job.decals[share.decal];
  const DecalMap& map = decal.map;
  BakeTransfer transfer = begin_transfer(job, target, share);
  const std::array<int, 2> size = {width, height};
  std::map<std::uint32_t, PartTexture> textures;  // by part
  const auto texture_on = [&](std::uint32_t part) -> const PartTexture& {
    return textures.try_emplace(part, job.model, job.model.parts[part], target.slot, size).first->second;
  };
  std::map<std::uint32_t, std::vector<char>> own;  // by part: the triangles that carry the decal
  for (const std::uint32_t part : target.parts) own[part].resize(job.model.parts[part].triangles.size(), 0);
  const auto add_face = [&](PatchFaceId f, const PartTexture& texture, std::size_t triangle) {
    const FaceCorners& inside = decal.surface->corners_in_source(map.patch.faces[f].mesh_face);
    TransferFace face;
    face.texel = texels_inside(texture.corners(triangle), inside);
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchVertexId vertex = map.patch.faces[f].vertices[k];
      face.plane[k] = map.plane[vertex];
      face.image[k] = map.image[vertex];
      if (map.groups == 1) continue;
      const auto influence = map.influence.begin() + std::ptrdiff_t{vertex.value} * map.groups;
      transfer.influence.insert(transfer.influence.end(), influence, influence + map.groups);
    }
    if (transfer.encoding == Encoding::normal) texture.turn(triangle, inside, decal.region.frame(), face);
    face.linear = map.linear[f] != 0;
    face.sheet = map.sheet[f];
    transfer.faces.push_back(face);
  };
  for_textured_faces(decal, [&](PatchFaceId f, const ModelSurface::Source& source) {
    const auto part = part_that_shows(job.model, decal.job, target.parts, source.part);
    if (!part) return;
    own.at(*part)[source.triangle] = 1;
    add_face(f, texture_on(source.part), source.triangle);
  });
  transfer.own = transfer.faces.size();
  std::map<std::uint32_t, ModelPart> parts_before;  // by separated part
  std::map<std::uint32_t, PartTexture> textures_before;
  for_textured_faces(decal, [&](PatchFaceId f, const ModelSurface::Source& source) {
    const auto part = former_part(job, decal.job, source.part);
    if (!part || !part_that_shows(job.model, decal.job, target.parts, *part)) return;
    auto texture = textures_before.find(source.part);
    if (texture == textures_before.end()) {
      ModelPart& before = parts_before[source.part];
      before = part_before(job.model, job.former.at(source.part));
      texture = textures_before.try_emplace(source.part, job.model, before, target.slot, size).first;
    }
    add_face(f, texture->second, job.model.parts[*part].triangles.size() + source.triangle);
  });
  const Surroundings surroundings(transfer, width, height);
  std::optional<Copies> copies;
  if (decal.job.uv_conflict == UvConflict::share) copies.emplace(transfer, width, height);
  for (const auto& [part, triangles] : own)
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (triangles[t] != 0) continue;
      const std::array<Texel, 3> corners = texture_on(part).corners(t);
      if (!surroundings.touch(corners)) continue;
      (copies && copies->has(corners) ? transfer.copies : transfer.foreign).push_back(corners);
    }
  return transfer;
}

std::optional<TexelDensity> texel_density(const SolvedDecal& decal,
                                          const std::vector<const BakeTransfer*>& transfers) {
  const double pixels_per_unit = decal.region.frame().pixels_per_unit();
  double texels = 0;
  double pixels = 0;
  for (const BakeTransfer* transfer : transfers)
    for (const TransferFace& face : std::span(transfer->faces).first(transfer->own)) {
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
