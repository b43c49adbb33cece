#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "applique/base/error.h"
#include "applique/base/types.h"

#include "model.h"

namespace applique {

/// What a joint has to say about a vertex.
struct Influence {
  std::uint32_t joint = 0;  ///< Index in the skin's list.
  double weight = 0;
};

/// How a skin moves the vertices of a primitive.
struct Skinning {
  std::vector<Eigen::Matrix4d> joints;  ///< From the mesh's space into the scene, at rest.
  std::size_t per_vertex = 0;           ///< Influences of a vertex; a multiple of 4.
  std::vector<Influence> influences;    ///< [vertex * per_vertex + i], as in the file.

  [[nodiscard]] std::span<const Influence> of_vertex(std::size_t vertex) const {
    return std::span(influences).subspan(vertex * per_vertex, per_vertex);
  }
};

/// Where a morph target moves the vertices of a primitive, in the mesh's space.
struct MorphTarget {
  std::vector<Vec3> positions;  ///< By vertex; empty: they stay.
  std::vector<Vec3> normals;    ///< By vertex; empty: they stay.
};

/// What moves a part when the model is posed, and how it is posed at rest.
struct Rig {
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();  ///< From the node's space into the scene.
  std::optional<Skinning> skin;
  std::vector<MorphTarget> targets;
  std::vector<double> rest_weights;  ///< By target.
  /// By target: how the surface's own normals turn, by vertex; empty where the positions stay. (The targets'
  /// normals may be anything: exporters write zeros.)
  std::vector<std::vector<Vec3>> turns;
};

/// The sum of the weighted joints, divided by the weights' sum (files round them); none where that is 0.
std::optional<Eigen::Matrix4d> blend_joints(const Skinning& skin, std::span<const Influence> influences);

/// The rigs of parts of the model, by their index. Errors: those of load_model.
Result<std::map<std::uint32_t, Rig>> read_rigs(const Model& model, const std::set<std::uint32_t>& parts);

}  // namespace applique
