#include "attach_overlay.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include <Eigen/LU>

#include "rig.h"

namespace applique {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;

/// A vertex of a part, and how much it counts.
struct Source {
  std::uint32_t vertex = 0;
  double weight = 0;

  auto operator<=>(const Source&) const = default;
};
using Sources = std::array<Source, 3>;

bool is_invertible(const Matrix4d& matrix) {
  constexpr double flattest = 1e-12;
  const Matrix3d linear = matrix.topLeftCorner<3, 3>();
  return std::abs(linear.determinant()) > flattest * std::pow(linear.norm(), 3);
}

/// Whether these vertices of a part can be taken back from the scene into the mesh's space.
bool can_follow(const Rig& rig, const std::set<std::uint32_t>& vertices) {
  if (!rig.skin) return is_invertible(rig.world);
  return std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) {
    return is_invertible(blend_joints(*rig.skin, rig.skin->of_vertex(v)).value_or(rig.world));
  });
}

/// The sources' influences, joint by joint, the heaviest first, at most `count` of them.
std::vector<Influence> blend_influences(const Skinning& skin, const Sources& sources, std::size_t count) {
  std::map<std::uint32_t, double> weights;
  for (const auto& [vertex, share] : sources) {
    if (share == 0) continue;
    double sum = 0;
    for (const Influence& influence : skin.of_vertex(vertex)) sum += influence.weight;
    for (const Influence& influence : skin.of_vertex(vertex))
      if (influence.weight > 0) weights[influence.joint] += share * influence.weight / sum;
  }
  std::vector<Influence> blend;
  for (const auto& [joint, weight] : weights) blend.push_back({joint, weight});
  std::stable_sort(blend.begin(), blend.end(),
                   [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  blend.resize(std::min(blend.size(), count));
  double sum = 0;
  for (const Influence& influence : blend) sum += influence.weight;
  for (Influence& influence : blend) influence.weight /= sum;
  // As floats they are to sum to 1 as well.
  float rest = 1;
  for (std::size_t i = 1; i < blend.size(); ++i) rest -= static_cast<float>(blend[i].weight);
  if (!blend.empty()) blend.front().weight = rest;
  blend.resize(count);
  return blend;
}

Vec3 blend_vectors(const std::vector<Vec3>& vectors, const Sources& sources) {
  Vec3 sum = Vec3::Zero();
  if (vectors.empty()) return sum;
  for (const auto& [vertex, weight] : sources) sum += weight * vectors[vertex];
  return sum;
}

/// Grows the overlay of one node.
class NodeOverlay {
 public:
  NodeOverlay(const SolvedDecal& decal, const DecalMesh& mesh) : decal_(&decal), mesh_(&mesh) {}

  /// `rig` is the part's; null where the overlay stays in the scene.
  void add_triangle(std::size_t triangle, std::uint32_t part_index, const ModelPart& part, const Rig* rig) {
    const auto& corners = mesh_->triangles[triangle];
    std::array<std::uint32_t, 3> added = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const Sources sources =
          rig != nullptr ? sources_of(corners[k], mesh_->faces[triangle], part) : Sources();
      const auto [found, fresh] =
          index_.try_emplace(Key(corners[k], rig != nullptr && moves(*rig) ? part_index : 0,
                                 rig != nullptr && moves(*rig) ? sources : Sources()),
                             static_cast<std::uint32_t>(overlay.positions.size()));
      if (fresh) add_vertex(corners[k], sources, rig);
      added[k] = found->second;
    }
    overlay.triangles.push_back(added);
  }

  OverlayMesh overlay;

 private:
  /// One vertex of the decal's mesh is several here where it blends different vertices of the model.
  using Key = std::tuple<std::uint32_t, std::uint32_t, Sources>;

  static bool moves(const Rig& rig) { return rig.skin || !rig.targets.empty(); }

  [[nodiscard]] Sources sources_of(std::uint32_t vertex, PatchFaceId face, const ModelPart& part) const {
    const DecalMesh::Origin& origin = mesh_->origins[vertex];
    const PatchFace& patch_face = decal_->map.patch.faces[face];
    const auto& triangle = part.triangles[decal_->surface->source(patch_face.mesh_face).triangle];
    const auto weights = weights_in_source(*decal_, origin, face);
    Sources sources;
    for (std::size_t k = 0; k < 3; ++k)
      if (weights[k] != 0) sources[k] = {triangle[k], weights[k]};
    return sources;
  }

  void add_vertex(std::uint32_t vertex, const Sources& sources, const Rig* rig) {
    const Vec3& position = mesh_->positions[vertex];
    const Vec3& normal = mesh_->normals[vertex];
    const Vec3& direction = mesh_->directions[vertex];
    overlay.uvs.push_back(mesh_->uvs[vertex]);
    if (rig == nullptr) {
      overlay.positions.push_back(position);
      overlay.normals.push_back(normal);
      return;
    }
    const Matrix4d inverse = add_influences(sources, *rig).inverse();
    const Matrix3d linear = inverse.topLeftCorner<3, 3>();
    if (rig->skin && linear.determinant() < 0) overlay.joints_mirror = true;
    const double height = (linear * (mesh_->heights[vertex] * direction)).norm();
    // Normals go by the inverse transpose; from the scene back, that is the transpose of the matrix itself.
    const Matrix3d back = linear.inverse().transpose();
    Vec3 unposed_direction = (back * direction).normalized();
    for (std::size_t t = 0; t < rig->turns.size(); ++t)
      unposed_direction -= rig->rest_weights[t] * blend_vectors(rig->turns[t], sources);
    unposed_direction.normalize();
    Vec3 unposed = (inverse * position.homogeneous()).head<3>();
    for (std::size_t t = 0; t < overlay.targets.size(); ++t)
      unposed -= weight_of(*rig, t) * add_target(t, sources, *rig, unposed_direction, height);
    overlay.positions.push_back(unposed);
    overlay.normals.push_back(without_targets((back * normal).normalized(), *rig));
  }

  /// The unit vector that the targets, as they are at rest, turn into the direction of `normal`; they have
  /// just been added.
  [[nodiscard]] Vec3 without_targets(const Vec3& normal, const Rig& rig) const {
    Vec3 moved = Vec3::Zero();
    for (std::size_t t = 0; t < overlay.targets.size(); ++t)
      if (!overlay.targets[t].normals.empty()) moved += weight_of(rig, t) * overlay.targets[t].normals.back();
    const double along = normal.dot(moved), square = along * along + 1 - moved.squaredNorm();
    const double length = along + std::sqrt(std::max(square, 0.0));
    if (square < 0 || length <= 0) return normal;  // No vector is.
    return length * normal - moved;
  }

  static double weight_of(const Rig& rig, std::size_t target) {
    return target < rig.rest_weights.size() ? rig.rest_weights[target] : 0;
  }

  /// Returns the matrix that the new vertex moves by at rest.
  Matrix4d add_influences(const Sources& sources, const Rig& rig) {
    const std::size_t count = overlay.influences_per_vertex;
    if (count == 0) return rig.world;
    std::vector<Influence> blend(count);
    std::optional<Matrix4d> matrix;
    if (rig.skin) {
      blend = blend_influences(*rig.skin, sources, count);
      matrix = blend_joints(*rig.skin, blend);
      if (matrix &&
          !is_invertible(*matrix)) {  // Between joints that face each other: with the nearest corner.
        const auto nearest = *std::max_element(
            sources.begin(), sources.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
        blend = blend_influences(*rig.skin, {Source{nearest.vertex, 1}}, count);
        matrix = blend_joints(*rig.skin, blend);
      }
    }
    overlay.influences.insert(overlay.influences.end(), blend.begin(), blend.end());
    return matrix.value_or(rig.world);
  }

  /// Returns how far the target moves the new vertex: with the surface, and with what it is lifted by.
  Vec3 add_target(std::size_t t, const Sources& sources, const Rig& rig, const Vec3& direction,
                  double height) {
    MorphTarget& target = overlay.targets[t];
    Vec3 move = Vec3::Zero();
    if (t < rig.targets.size()) {
      const Vec3 turned = direction + blend_vectors(rig.turns[t], sources);
      move = blend_vectors(rig.targets[t].positions, sources);
      if (turned.norm() > 0) move += height * (turned.normalized() - direction);
      if (!rig.targets[t].normals.empty()) {
        target.normals.resize(target.positions.size(), Vec3::Zero());
        target.normals.push_back(blend_vectors(rig.targets[t].normals, sources));
      }
    }
    target.positions.push_back(move);
    if (!target.normals.empty()) target.normals.resize(target.positions.size(), Vec3::Zero());
    return move;
  }

  const SolvedDecal* decal_;
  const DecalMesh* mesh_;
  std::map<Key, std::uint32_t> index_;
};

/// Turns x over.
void turn_over(OverlayMesh& overlay) {
  const auto turn = [](std::vector<Vec3>& vectors) {
    for (Vec3& vector : vectors) vector.x() = -vector.x();
  };
  turn(overlay.positions);
  turn(overlay.normals);
  for (MorphTarget& target : overlay.targets) {
    turn(target.positions);
    turn(target.normals);
  }
}

}  // namespace

Result<std::vector<OverlayMesh>> attach_overlay(const Model& model, const SolvedDecal& decal,
                                                const DecalMesh& mesh) {
  const auto source_of = [&](std::size_t triangle) -> const ModelSurface::Source& {
    return decal.surface->source(decal.map.patch.faces[mesh.faces[triangle]].mesh_face);
  };
  std::map<std::uint32_t, std::set<std::uint32_t>> covered;  // by part: the vertices under the decal
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [part, triangle] = source_of(t);
    const auto& corners = model.parts[part].triangles[triangle];
    covered[part].insert(corners.begin(), corners.end());
  }
  std::set<std::uint32_t> parts;
  for (const auto& [part, vertices] : covered) parts.insert(part);
  APPLIQUE_TRY(const auto rigs, read_rigs(model, parts));

  // What one of a node's parts cannot do, none of them does.
  std::map<std::optional<std::size_t>, NodeOverlay> overlays;
  std::set<std::size_t> fixed;
  for (const auto& [part, rig] : rigs)
    if (!can_follow(rig, covered.at(part))) fixed.insert(model.parts[part].node);
  const auto node_of = [&](std::uint32_t part) -> std::optional<std::size_t> {
    const std::size_t node = model.parts[part].node;
    if (fixed.contains(node)) return std::nullopt;
    return node;
  };
  for (const auto& [part, rig] : rigs) {
    const auto node = node_of(part);
    OverlayMesh& overlay = overlays.try_emplace(node, decal, mesh).first->second.overlay;
    overlay.node = node;
    if (!node) continue;
    overlay.mirrored = model.parts[part].mirrored && !rig.skin;
    if (rig.skin)
      overlay.influences_per_vertex = std::max(overlay.influences_per_vertex, rig.skin->per_vertex);
    overlay.targets.resize(std::max(overlay.targets.size(), rig.targets.size()));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t part = source_of(t).part;
    const auto node = node_of(part);
    overlays.at(node).add_triangle(t, part, model.parts[part], node ? &rigs.at(part) : nullptr);
  }
  std::vector<OverlayMesh> list;
  for (auto& [node, grown] : overlays) {
    if (grown.overlay.mirrored) turn_over(grown.overlay);
    list.push_back(std::move(grown.overlay));
  }
  return list;
}

}  // namespace applique
