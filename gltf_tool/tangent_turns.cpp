#include "tangent_turns.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include "texel_map.h"
#include "uv_raster.h"

namespace applique {
namespace {

using Corners = std::vector<std::array<Texel, 3>>;

/// A tangent and the side of the bitangent: +1 where normal x tangent is one.
struct CornerTangent {
  Vec3 along = Vec3::Zero();
  double side = 1;

  [[nodiscard]] bool valid() const { return along != Vec3::Zero(); }
};

Vec3 across(const Vec3& vector, const Vec3& normal) {
  const Vec3 part = vector - normal * normal.dot(vector);
  const double length = part.norm();
  return length > 1e-12 * vector.norm() ? Vec3(part / length) : Vec3(Vec3::Zero());
}

std::array<Vec3, 3> corners_of(const TangentFrames& frames, std::size_t t) {
  const auto& triangle = frames.triangles[t];
  return {frames.positions[triangle[0]], frames.positions[triangle[1]], frames.positions[triangle[2]]};
}

Vec3 normal_at(const TangentFrames& frames, std::size_t t, std::size_t k) {
  const auto p = corners_of(frames, t);
  const Vec3 normal = frames.normals.empty() ? Vec3((p[1] - p[0]).cross(p[2] - p[0]))
                                             : frames.normals[frames.triangles[t][k]];
  return normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
}

/// The direction of u on the triangle, of a length in proportion to its area; zero where it has none.
Vec3 direction_of_u(const std::array<Vec3, 3>& p, const std::array<Texel, 3>& uv) {
  const double determinant = doubled_area(uv);
  if (determinant == 0) return Vec3::Zero();
  const Vec3 along =
      ((uv[2][1] - uv[0][1]) * (p[1] - p[0]) - (uv[1][1] - uv[0][1]) * (p[2] - p[0])) / determinant;
  const double area = (p[1] - p[0]).cross(p[2] - p[0]).norm();
  return along.norm() > 0 ? Vec3(area * along.normalized()) : Vec3(Vec3::Zero());
}

/// The tangents of a layout at each corner.
std::vector<std::array<CornerTangent, 3>> tangents_of(const TangentFrames& frames, const Corners& layout) {
  using Place = std::tuple<std::uint32_t, double, double, bool>;
  std::map<Place, Vec3> sums;
  const auto place = [&](std::size_t t, std::size_t k) {
    // Flat faces share nothing.
    const auto vertex =
        frames.normals.empty() ? static_cast<std::uint32_t>(3 * t + k) : frames.triangles[t][k];
    return Place{vertex, layout[t][k][0], layout[t][k][1], doubled_area(layout[t]) < 0};
  };
  for (std::size_t t = 0; t < layout.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      sums.try_emplace(place(t, k), Vec3::Zero()).first->second +=
          direction_of_u(corners_of(frames, t), layout[t]);
  std::vector<std::array<CornerTangent, 3>> tangents(layout.size());
  for (std::size_t t = 0; t < layout.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      // Seen from outside, v runs down and the bitangent up: a layout that is not mirrored has a negative
      // area.
      tangents[t][k] = {across(sums.at(place(t, k)), normal_at(frames, t, k)),
                        doubled_area(layout[t]) < 0 ? 1.0 : -1.0};
  return tangents;
}

std::vector<std::array<CornerTangent, 3>> old_tangents(const TangentFrames& frames) {
  if (frames.tangents.empty()) return tangents_of(frames, frames.old_corners);
  std::vector<std::array<CornerTangent, 3>> tangents(frames.triangles.size());
  for (std::size_t t = 0; t < tangents.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& tangent = frames.tangents[frames.triangles[t][k]];
      tangents[t][k] = {across({tangent[0], tangent[1], tangent[2]}, normal_at(frames, t, k)),
                        tangent[3] < 0 ? -1.0 : 1.0};
    }
  return tangents;
}

FrameTurn turn_between(const CornerTangent& from, const CornerTangent& to, const Vec3& normal) {
  if (!from.valid() || !to.valid()) return {};
  const Vec3 old_up = from.side * normal.cross(from.along);
  const Vec3 new_up = to.side * normal.cross(to.along);
  return {from.along.dot(to.along), old_up.dot(to.along), from.along.dot(new_up), old_up.dot(new_up)};
}

}  // namespace

TangentTurns turn_tangents(const TangentFrames& frames) {
  const auto before = old_tangents(frames);
  const auto after = tangents_of(frames, frames.new_corners);
  TangentTurns result;
  result.turns.resize(frames.triangles.size());
  result.tangents.resize(frames.triangles.size());
  for (std::size_t t = 0; t < frames.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 normal = normal_at(frames, t, k);
      result.turns[t][k] = turn_between(before[t][k], after[t][k], normal);
      const Vec3 along = after[t][k].valid() ? after[t][k].along : Vec3(normal.unitOrthogonal());
      result.tangents[t][k] = {static_cast<float>(along.x()), static_cast<float>(along.y()),
                               static_cast<float>(along.z()), static_cast<float>(after[t][k].side)};
    }
  return result;
}

bool same_frames(const Corners& old_corners, const Corners& new_corners) {
  constexpr double tolerance = 1e-3;
  for (std::size_t t = 0; t < old_corners.size(); ++t) {
    // What is collapsed had no frame.
    if (doubled_area(old_corners[t]) == 0 || doubled_area(new_corners[t]) == 0) continue;
    const TexelMap map = map_between(old_corners[t], new_corners[t]);
    const double size = half_axes(map)[0];
    if (!(map.xx > 0 && map.yy > 0 && std::abs(map.xy) < tolerance * size &&
          std::abs(map.yx) < tolerance * size))
      return false;
  }
  return true;
}

}  // namespace applique
