#include "decal_view.h"

#include <algorithm>
#include <array>
#include <vector>

#include <Eigen/Geometry>

namespace applique {
namespace {

struct FaceFrame {
  std::vector<Vec3> corners;  ///< Of what lies in the region's bounding box.
  Vec3 normal;                ///< Length: twice the area.
  Vec3 up;                    ///< Where the image's y grows, times twice the area.
};

struct Corner {
  Vec2 image;
  Vec3 position;
};

/// The part of a polygon where dot(direction, image) <= limit (Sutherland and Hodgman 1974).
std::vector<Corner> cut(const std::vector<Corner>& polygon, Vec2 direction, double limit) {
  std::vector<Corner> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Corner& a = polygon[k];
    const Corner& b = polygon[(k + 1) % polygon.size()];
    const double over_a = dot(direction, a.image) - limit;
    const double over_b = dot(direction, b.image) - limit;
    if (over_a <= 0) kept.push_back(a);
    if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0)) {
      const double t = over_a / (over_a - over_b);
      kept.push_back({a.image + t * (b.image - a.image), a.position + t * (b.position - a.position)});
    }
  }
  return kept;
}

constexpr std::array<Vec2, 4> directions = {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)};

/// The region's extent in each of the directions.
using Limits = std::array<double, 4>;

Limits limits_of(const Region& region) {
  Limits limits = {};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    limits[i] = dot(directions[i], region.polygon().front());
    for (const Vec2 z : region.polygon()) limits[i] = std::max(limits[i], dot(directions[i], z));
  }
  return limits;
}

/// The corners of the face's part in the bounding box of the region: a large face reaches far beyond the
/// decal.
std::vector<Vec3> corners_in_box(const SolvedDecal& decal, const PatchFace& face, const Limits& limits) {
  const auto positions = decal.surface->mesh.corners(face.mesh_face);
  std::vector<Corner> polygon;
  for (std::size_t k = 0; k < 3; ++k) polygon.push_back({decal.map.image[face.vertices[k]], positions[k]});
  for (std::size_t i = 0; i < limits.size(); ++i) polygon = cut(polygon, directions[i], limits[i]);
  std::vector<Vec3> corners;
  for (const Corner& corner : polygon) corners.push_back(corner.position);
  return corners;
}

/// The surface as a function of the image (s, t) is linear on a face: its derivative by t is the image's up.
FaceFrame frame_of(const SolvedDecal& decal, const PatchFace& face, const Limits& limits) {
  FaceFrame frame;
  frame.corners = corners_in_box(decal, face, limits);
  const auto q = decal.surface->mesh.corners(face.mesh_face);
  frame.normal = (q[1] - q[0]).cross(q[2] - q[0]);
  std::array<double, 3> s = {};
  for (std::size_t k = 0; k < 3; ++k) s[k] = decal.map.image[face.vertices[k]].real();
  const Vec3 by_t = q[0] * (s[2] - s[1]) + q[1] * (s[0] - s[2]) + q[2] * (s[1] - s[0]);
  const double length = by_t.norm();
  frame.up = length > 0 ? Vec3(by_t * (frame.normal.norm() / length)) : Vec3::Zero();
  return frame;
}

std::vector<FaceFrame> frames_of(const SolvedDecal& decal) {
  const Limits limits = limits_of(decal.region);
  std::vector<FaceFrame> frames;
  for (const PatchFaceId f : ids<PatchFaceId>(decal.map.patch.faces.size())) {
    const PatchFace& face = decal.map.patch.faces[f];
    if (decal.map.textured[f] != 0 && face.mesh_face.valid()) frames.push_back(frame_of(decal, face, limits));
  }
  return frames;
}

/// `v` made a unit vector, or `fallback` where it is too short for that.
Vec3 unit_or(const Vec3& v, double scale, const Vec3& fallback) {
  constexpr double shortest = 1e-3;
  return v.norm() > shortest * scale ? v.normalized() : fallback;
}

}  // namespace

DecalView view_of_decal(const SolvedDecal& decal) {
  const std::vector<FaceFrame> frames = frames_of(decal);
  APPLIQUE_ASSERT(!frames.empty());
  Vec3 normal = Vec3::Zero();
  Vec3 up = Vec3::Zero();
  double area = 0;
  for (const FaceFrame& frame : frames) {
    normal += frame.normal;
    up += frame.up;
    area += frame.normal.norm();
  }
  DecalView view;
  // A decal that goes all the way round something has no mean: one of its faces stands for it.
  view.towards_viewer = unit_or(normal, area, unit_or(frames.front().normal, 0, Vec3::UnitZ()));
  up -= view.towards_viewer * up.dot(view.towards_viewer);
  view.up = unit_or(up, area, view.towards_viewer.unitOrthogonal());

  for (const FaceFrame& frame : frames)
    view.points.insert(view.points.end(), frame.corners.begin(), frame.corners.end());
  return view;
}

}  // namespace applique
