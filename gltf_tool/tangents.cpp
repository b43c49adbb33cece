#include "tangents.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace applique {
namespace {

/// A triangle's texture direction: of u, and whether the texture shows mirrored.
struct UvDirection {
  Vec3 along_u = Vec3::Zero();  ///< Any length; 0 where the triangle has no area in the texture.
  bool mirrored = false;
};

UvDirection uv_direction(const ModelPart& part, std::span<const std::array<double, 2>> uvs,
                         const std::array<std::uint32_t, 3>& t) {
  const Vec3 p1 = part.positions[t[1]] - part.positions[t[0]],
             p2 = part.positions[t[2]] - part.positions[t[0]];
  const double u1 = uvs[t[1]][0] - uvs[t[0]][0], v1 = uvs[t[1]][1] - uvs[t[0]][1];
  const double u2 = uvs[t[2]][0] - uvs[t[0]][0], v2 = uvs[t[2]][1] - uvs[t[0]][1];
  const double area = u1 * v2 - u2 * v1;
  // Seen from outside, with v down, corners that go round counter-clockwise have a negative area.
  return {(area < 0 ? -1 : 1) * (v2 * p1 - v1 * p2) * (area == 0 ? 0 : 1), area > 0};
}

Vec3 in_tangent_plane(const Vec3& direction, const Vec3& normal) {
  const Vec3 flat = direction - normal.dot(direction) * normal;
  const double length = flat.norm();
  return length > 0 ? Vec3(flat / length) : Vec3(Vec3::Zero());
}

/// Any direction across the normal.
Vec3 any_tangent(const Vec3& normal) {
  return in_tangent_plane(std::abs(normal.x()) < 0.9 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY()), normal);
}

}  // namespace

std::vector<std::array<Tangent, 3>> tangent_frames(const ModelPart& part,
                                                   std::span<const std::array<double, 2>> uvs) {
  std::vector<std::array<Tangent, 3>> frames(part.triangles.size());
  if (!part.tangents.empty()) {
    for (std::size_t t = 0; t < frames.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) frames[t][k] = part.tangents[part.triangles[t][k]];
    return frames;
  }

  using Key = std::tuple<std::array<double, 3>, std::array<double, 3>, std::array<double, 2>, bool>;
  const auto key = [&](std::uint32_t vertex, const Vec3& n, bool mirrored) {
    const Vec3& p = part.positions[vertex];
    return Key({p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, uvs[vertex], mirrored);
  };
  std::map<Key, Vec3> sums;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& t = part.triangles[i];
    const UvDirection direction = uv_direction(part, uvs, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 normal = shading_normal(part, i, k);
      const Vec3 next = in_tangent_plane(part.positions[t[(k + 1) % 3]] - part.positions[t[k]], normal);
      const Vec3 last = in_tangent_plane(part.positions[t[(k + 2) % 3]] - part.positions[t[k]], normal);
      const double angle = std::acos(std::clamp(next.dot(last), -1.0, 1.0));
      sums.try_emplace(key(t[k], normal, direction.mirrored), Vec3::Zero()).first->second +=
          angle * in_tangent_plane(direction.along_u, normal);
    }
  }
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const bool mirrored = uv_direction(part, uvs, part.triangles[t]).mirrored;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = part.triangles[t][k];
      const Vec3 normal = shading_normal(part, t, k);
      const Vec3 along = in_tangent_plane(sums.at(key(vertex, normal, mirrored)), normal);
      frames[t][k] = {along.isZero() ? any_tangent(normal) : along, mirrored ? -1.0 : 1.0};
    }
  }
  return frames;
}

NormalMapFrame frame_inside(const ModelPart& part, std::size_t triangle, const std::array<Tangent, 3>& frames,
                            const std::array<double, 3>& weights) {
  NormalMapFrame frame;
  frame.normal =
      blend(weights, [&](std::size_t i) { return shading_normal(part, triangle, i); }).normalized();
  const Vec3 direction = blend(weights, [&](std::size_t i) { return frames[i].direction; });
  frame.tangent = (direction - frame.normal.dot(direction) * frame.normal).normalized();
  const double sign = blend(weights, [&](std::size_t i) { return frames[i].sign; });
  frame.bitangent = std::copysign(1, sign) * frame.normal.cross(frame.tangent);
  return frame;
}

std::optional<std::vector<std::array<float, 4>>> vertex_tangents(
    const ModelPart& part, const std::vector<std::array<Tangent, 3>>& frames) {
  std::vector<std::array<float, 4>> tangents(part.positions.size(), {1, 0, 0, 0});
  for (std::size_t t = 0; t < frames.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& [direction, sign] = frames[t][k];
      std::array<float, 4>& tangent = tangents[part.triangles[t][k]];
      const auto side = static_cast<float>(sign);
      if (tangent[3] != 0 && tangent[3] != side) return std::nullopt;
      for (int c = 0; c < 3; ++c) tangent[static_cast<std::size_t>(c)] = static_cast<float>(direction[c]);
      tangent[3] = side;
    }
  for (auto& tangent : tangents)
    if (tangent[3] == 0) tangent[3] = 1;  // A vertex of no triangle.
  return tangents;
}

}  // namespace applique
