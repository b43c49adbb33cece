#include "posing.h"

#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry.h"

namespace applique {
namespace {

using Eigen::Matrix4d;

Matrix4d local_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Matrix4d>(node.matrix.data());
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3) transform.translate(Eigen::Map<const Vec3>(node.translation.data()));
  if (node.rotation.size() == 4) {
    const Eigen::Quaterniond q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (q.norm() > 0) transform.rotate(q.normalized());
  }
  if (node.scale.size() == 3) transform.scale(Eigen::Map<const Vec3>(node.scale.data()));
  return transform.matrix();
}

const tinygltf::Primitive& primitive_of(const tinygltf::Model& geometry, const PartKey& part) {
  return geometry.meshes[part.mesh].primitives[part.primitive];
}

std::string place_of(const Document& document, const PartKey& part) {
  return fmt::format("'{}', mesh {}, primitive {}", document.name, part.mesh, part.primitive);
}

std::size_t vertex_count(const tinygltf::Model& geometry, const tinygltf::Primitive& primitive) {
  return geometry.accessors[static_cast<std::size_t>(primitive.attributes.at("POSITION"))].count;
}

Result<void> check_count(std::size_t found, std::size_t expected, const std::string& what) {
  if (found == expected) return {};
  return fail(ErrorCode::model_invalid,
              fmt::format("{} has {} elements, POSITION has {}", what, found, expected));
}

/// The joints' matrices at rest, with the inverse bind matrices.
Result<std::vector<Matrix4d>> read_joints(const Document& document, const tinygltf::Model& geometry,
                                          std::span<const Matrix4d> world, std::size_t skin_index) {
  const auto& skin = geometry.skins[skin_index];
  std::vector<Matrix4d> joints;
  for (const int joint : skin.joints) joints.push_back(world[static_cast<std::size_t>(joint)]);
  if (skin.inverseBindMatrices < 0) return joints;
  const std::string where = fmt::format("'{}', skin {}", document.name, skin_index);
  APPLIQUE_TRY(const auto values,
               read_accessor(geometry, skin.inverseBindMatrices, 16, where + ", inverseBindMatrices"));
  if (values.size() / 16 < joints.size())
    return fail(ErrorCode::model_invalid, fmt::format("{}: {} inverse bind matrices for {} joints", where,
                                                      values.size() / 16, joints.size()));
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] *= Eigen::Map<const Matrix4d>(&values[16 * j]);
  return joints;
}

}  // namespace

std::vector<Matrix4d> world_matrices(const tinygltf::Model& geometry) {
  std::vector<Matrix4d> world;
  std::vector<char> has_parent(geometry.nodes.size(), 0);
  for (const auto& node : geometry.nodes) {
    world.push_back(local_matrix(node));
    for (const int child : node.children) has_parent[static_cast<std::size_t>(child)] = 1;
  }
  std::vector<std::size_t> stack;
  for (std::size_t i = 0; i < world.size(); ++i)
    if (has_parent[i] == 0) stack.push_back(i);
  while (!stack.empty()) {
    const std::size_t node = stack.back();
    stack.pop_back();
    for (const int child : geometry.nodes[node].children) {
      stack.push_back(static_cast<std::size_t>(child));
      world[stack.back()] = world[node] * world[stack.back()];
    }
  }
  return world;
}

Result<std::optional<Skinning>> read_skinning(const Document& document, const tinygltf::Model& geometry,
                                              std::span<const Matrix4d> world, const PartKey& part) {
  const int skin_index = geometry.nodes[part.node].skin;
  const auto& attributes = primitive_of(geometry, part).attributes;
  if (skin_index < 0 || !attributes.contains("JOINTS_0") || !attributes.contains("WEIGHTS_0"))
    return std::nullopt;
  Skinning skin;
  APPLIQUE_TRY(skin.joints, read_joints(document, geometry, world, static_cast<std::size_t>(skin_index)));
  const std::size_t vertices = vertex_count(geometry, primitive_of(geometry, part));
  std::size_t sets = 0;
  while (attributes.contains(fmt::format("JOINTS_{}", sets)) &&
         attributes.contains(fmt::format("WEIGHTS_{}", sets)))
    ++sets;
  skin.per_vertex = 4 * sets;
  skin.influences.resize(vertices * skin.per_vertex);
  for (std::size_t set = 0; set < sets; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set);
    const std::string weights_name = fmt::format("WEIGHTS_{}", set);
    const std::string where = place_of(document, part);
    APPLIQUE_TRY(const auto joints, read_integers(geometry, attributes.at(joints_name), 4,
                                                  fmt::format("{}, {}", where, joints_name)));
    APPLIQUE_CHECK(check_count(joints.size() / 4, vertices, fmt::format("{}: {}", where, joints_name)));
    APPLIQUE_TRY(const auto weights, read_accessor(geometry, attributes.at(weights_name), 4,
                                                   fmt::format("{}, {}", where, weights_name)));
    APPLIQUE_CHECK(check_count(weights.size() / 4, vertices, fmt::format("{}: {}", where, weights_name)));
    for (std::size_t i = 0; i < 4 * vertices; ++i) {
      if (weights[i] == 0) continue;
      if (joints[i] >= skin.joints.size())
        return fail(ErrorCode::model_invalid, fmt::format("{}: {} names joint {} of {}", where, joints_name,
                                                          joints[i], skin.joints.size()));
      skin.influences[i / 4 * skin.per_vertex + 4 * set + i % 4] = {joints[i], weights[i]};
    }
  }
  return skin;
}

Result<MorphTarget> read_morph_target(const Document& document, const tinygltf::Model& geometry,
                                      const PartKey& part, std::size_t target) {
  const auto& primitive = primitive_of(geometry, part);
  const std::size_t vertices = vertex_count(geometry, primitive);
  const auto read = [&](const std::string& name) -> Result<std::vector<Vec3>> {
    const auto found = primitive.targets[target].find(name);
    if (found == primitive.targets[target].end()) return std::vector<Vec3>();
    const std::string where = place_of(document, part);
    APPLIQUE_TRY(const auto values,
                 read_accessor(geometry, found->second, 3,
                               fmt::format("{}, morph target {}, {}", where, target, name)));
    APPLIQUE_CHECK(check_count(values.size() / 3, vertices,
                               fmt::format("{}: morph target {}'s {}", where, target, name)));
    return to_vectors(values);
  };
  MorphTarget morph;
  APPLIQUE_TRY(morph.positions, read("POSITION"));
  APPLIQUE_TRY(morph.normals, read("NORMAL"));
  return morph;
}

const std::vector<double>& rest_weights(const tinygltf::Model& geometry, const PartKey& part) {
  const auto& weights = geometry.nodes[part.node].weights;
  return weights.empty() ? geometry.meshes[part.mesh].weights : weights;
}

}  // namespace applique
