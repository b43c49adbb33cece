#include "rig.h"

#include <utility>

#include "geometry.h"
#include "posing.h"

namespace applique {
namespace {

/// How smooth normals of the mesh turn where a target moves it.
Result<std::vector<Vec3>> read_turns(const Document& document, const tinygltf::Model& geometry,
                                     const ModelPart& part, const MorphTarget& target) {
  const auto& primitive = geometry.meshes[part.mesh].primitives[part.primitive];
  APPLIQUE_TRY(const auto values, read_accessor(geometry, primitive.attributes.at("POSITION"), 3,
                                                "'" + document.name + "', POSITION"));
  std::vector<Vec3> positions = to_vectors(values);
  auto turns = smooth_normals(positions, part.triangles);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += target.positions[i];
  const auto moved = smooth_normals(positions, part.triangles);
  const double side = part.mirrored ? -1 : 1;  // The part's triangles are turned over against the file.
  for (std::size_t i = 0; i < turns.size(); ++i)
    turns[i] = side * (moved[i].normalized() - turns[i].normalized());
  return turns;
}

Result<Rig> read_rig(const Document& document, const tinygltf::Model& geometry,
                     std::span<const Eigen::Matrix4d> world, const ModelPart& part) {
  const PartKey key = {part.node, part.mesh, part.primitive};
  Rig rig;
  rig.world = world[part.node];
  APPLIQUE_TRY(rig.skin, read_skinning(document, geometry, world, key));
  const std::size_t targets = geometry.meshes[part.mesh].primitives[part.primitive].targets.size();
  for (std::size_t t = 0; t < targets; ++t) {
    APPLIQUE_TRY(MorphTarget target, read_morph_target(document, geometry, key, t));
    if (part.flat) target.normals.clear();  // There is nothing that they would move.
    rig.turns.emplace_back();
    if (!target.positions.empty()) {
      APPLIQUE_TRY(rig.turns.back(), read_turns(document, geometry, part, target));
    }
    rig.targets.push_back(std::move(target));
  }
  rig.rest_weights = rest_weights(geometry, key);
  rig.rest_weights.resize(targets, 0);
  return rig;
}

}  // namespace

std::optional<Eigen::Matrix4d> blend_joints(const Skinning& skin, std::span<const Influence> influences) {
  Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();
  double sum = 0;
  for (const auto& [joint, weight] : influences) {
    if (weight == 0) continue;
    blend += weight * skin.joints[joint];
    sum += weight;
  }
  if (sum <= 0) return std::nullopt;
  return Eigen::Matrix4d(blend / sum);
}

Result<std::map<std::uint32_t, Rig>> read_rigs(const Model& model, const std::set<std::uint32_t>& parts) {
  APPLIQUE_TRY(const Buffers buffers, read_buffers(model.document));
  APPLIQUE_TRY(const tinygltf::Model geometry, decode_geometry(model.document, buffers));
  const auto world = world_matrices(geometry);
  std::map<std::uint32_t, Rig> rigs;
  for (const std::uint32_t part : parts) {
    APPLIQUE_TRY(rigs[part], read_rig(model.document, geometry, world, model.parts[part]));
  }
  return rigs;
}

}  // namespace applique
