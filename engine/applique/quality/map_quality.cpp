#include "applique/quality/map_quality.h"

#include <algorithm>
#include <cmath>

#include "applique/base/convex_clip.h"
#include "applique/base/predicates.h"

namespace applique {
namespace {

/// Whether the warp reverses orientation at a corner of the triangle or in its middle, by central
/// differences. `influence` of the groups at each corner; linear between.
bool turns_over(const Warp& warp, const std::array<Vec2, 3>& triangle,
                const std::array<std::span<const double>, 3>& influence) {
  const Vec2 e1 = triangle[1] - triangle[0], e2 = triangle[2] - triangle[0];
  std::vector<double> there(influence[0].size());
  const auto warped = [&](Vec2 z) {
    const double u = cross(z - triangle[0], e2) / cross(e1, e2);
    const double v = cross(e1, z - triangle[0]) / cross(e1, e2);
    for (std::size_t g = 0; g < there.size(); ++g)
      there[g] = (1 - u - v) * influence[0][g] + u * influence[1][g] + v * influence[2][g];
    return warp(z, there);
  };
  constexpr double step = 1e-6;
  for (const Vec2 z :
       {triangle[0], triangle[1], triangle[2], (triangle[0] + triangle[1] + triangle[2]) / 3.0}) {
    const Vec2 along_x = warped(z + step) - warped(z - step);
    const Vec2 along_y = warped(z + Vec2(0, step)) - warped(z - Vec2(0, step));
    if (cross(along_x, along_y) <= 0) return true;
  }
  return false;
}

/// Of the faces whose middles the map shows, the share, by area in the plane, that others lie over there. An
/// embedding is linear in each triangle, which makes this exact where a warp bends the triangles' images.
double doubled_in_plane(const Patch& patch, const IdVector<PatchVertexId, Vec2>& plane,
                        const IdVector<PatchFaceId, char>& textured, const Warp& warp, const Region& region) {
  struct Face {
    std::array<Vec2, 3> corners;
    Vec2 middle;
    double left, right, area;
    bool doubled = false;
  };
  std::vector<Face> faces;
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    const auto& v = patch.faces[q].vertices;
    const std::array<Vec2, 3> t = {plane[v[0]], plane[v[1]], plane[v[2]]};
    const Vec2 middle = (t[0] + t[1] + t[2]) / 3.0;
    if (!textured[q] || orientation(t[0], t[1], t[2]) <= 0 || !region.contains(warp(middle))) continue;
    const auto [left, right] = std::minmax({t[0].real(), t[1].real(), t[2].real()});
    faces.push_back({t, middle, left, right, cross(t[1] - t[0], t[2] - t[0])});
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.left < b.left; });
  const auto lies_in = [](Vec2 z, const std::array<Vec2, 3>& t) {
    return cross(t[1] - t[0], z - t[0]) > 0 && cross(t[2] - t[1], z - t[1]) > 0 &&
           cross(t[0] - t[2], z - t[2]) > 0;
  };
  // A sweep from left to right: only faces whose columns overlap can lie over one another.
  std::vector<Face*> open;
  for (Face& face : faces) {
    std::erase_if(open, [&](const Face* other) { return other->right < face.left; });
    for (Face* other : open) {
      face.doubled = face.doubled || lies_in(face.middle, other->corners);
      other->doubled = other->doubled || lies_in(other->middle, face.corners);
    }
    open.push_back(&face);
  }
  double whole = 0, doubled = 0;
  for (const Face& face : faces) (face.doubled ? doubled : whole) += face.doubled ? face.area / 2 : face.area;
  return whole + doubled > 0 ? doubled / (whole + doubled) : 0;
}

}  // namespace

SingularValues singular_values(const std::array<Vec3, 3>& corners, const std::array<Vec2, 3>& image) {
  const Vec2 e1 = image[1] - image[0], e2 = image[2] - image[0];
  const double double_area = cross(e1, e2);
  const Vec3 d1 = corners[1] - corners[0], d2 = corners[2] - corners[0];
  const Vec3 s = (d1 * e2.imag() - d2 * e1.imag()) / double_area;
  const Vec3 t = (d2 * e1.real() - d1 * e2.real()) / double_area;
  const double a = s.squaredNorm(), b = s.dot(t), c = t.squaredNorm();
  const double root = std::hypot(a - c, 2 * b);
  return {std::sqrt(0.5 * (a + c + root)), std::sqrt(std::max(0.0, 0.5 * (a + c - root)))};
}

double area_in_region(const Region& region, const std::array<Vec2, 3>& triangle) {
  const double whole = 0.5 * cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  // The region has no holes: a triangle whose sides lie in it lies in it.
  if (region.contains_segment(triangle[0], triangle[1]) &&
      region.contains_segment(triangle[1], triangle[2]) && region.contains_segment(triangle[2], triangle[0]))
    return whole;
  std::vector<Vec2> polygon = region.polygon();
  for (int k = 0; k < 3; ++k) polygon = clip_left_of(polygon, triangle[k], triangle[(k + 1) % 3]);
  // About one of its own corners: the triangle's may be so far away that the area is lost to rounding.
  double area = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    area += 0.5 * cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return std::clamp(area, 0.0, whole);
}

MapQuality measure_quality(const SurfaceMesh& surface, const Patch& patch,
                           const IdVector<PatchVertexId, Vec2>& plane,
                           const IdVector<PatchVertexId, Vec2>& image,
                           const IdVector<PatchFaceId, char>& textured, const Warp& warp,
                           const Region& region, std::span<const double> influence) {
  MapQuality quality;
  const auto influence_at = [&](PatchVertexId v) {
    return warp.groups > 1 ? influence.subspan(std::size_t{v.value} * warp.groups, warp.groups)
                           : std::span<const double>();
  };
  struct Measured {
    SingularValues singular;
    double area;  ///< On the surface, under the region.
  };
  std::vector<Measured> measured;
  double image_area = 0;
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    if (!textured[q]) continue;
    const auto& v = patch.faces[q].vertices;
    const std::array<Vec2, 3> flat = {plane[v[0]], plane[v[1]], plane[v[2]]};
    const bool flipped = orientation(flat[0], flat[1], flat[2]) <= 0;
    quality.flipped_plane += flipped;
    const std::array<Vec2, 3> p = {image[v[0]], image[v[1]], image[v[2]]};
    if (orientation(p[0], p[1], p[2]) <= 0) {
      quality.flipped_image +=
          flipped || turns_over(warp, flat, {influence_at(v[0]), influence_at(v[1]), influence_at(v[2])});
      continue;
    }
    const double whole = 0.5 * cross(p[1] - p[0], p[2] - p[0]);
    if (!(whole > 0)) continue;  // Too thin for its area to be told.
    const std::array<Vec3, 3> corners = surface.corners(patch.faces[q].mesh_face);
    const double inside = area_in_region(region, p);
    const double share = inside / whole;
    image_area += inside;
    const double area = share * 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    if (area > 0) measured.push_back({singular_values(corners, p), area});
    quality.area += area;
  }
  quality.coverage = image_area / region.area();
  quality.doubled = std::max(0.0, quality.coverage - 1);
  // What the corners of bent triangles enclose may be too much.
  if (quality.doubled > hardly_doubled && warp.steps > 0 && warp.groups == 1) {
    quality.doubled = doubled_in_plane(patch, plane, textured, warp, region);
    quality.coverage = std::min(quality.coverage, 1 + quality.doubled);
  }
  if (measured.empty()) return quality;

  const double normal = std::sqrt(image_area / quality.area);  // makes the total areas equal
  double l2 = 0, angle = 0, area_ratio = 0;
  for (const auto& [s, area] : measured) {
    l2 += s.squared_l2_stretch() * area;
    quality.linf_stretch = std::max(quality.linf_stretch, s.larger * normal);
    const double ratio = s.larger * s.smaller * normal * normal;
    angle += s.smaller > 0 ? s.larger / s.smaller * area : 0;
    area_ratio += ratio > 0 ? std::max(ratio, 1 / ratio) * area : 0;
  }
  quality.raw_l2_stretch = std::sqrt(l2 / quality.area);
  quality.l2_stretch = quality.raw_l2_stretch * normal;
  quality.angle_distortion = angle / quality.area;
  quality.area_distortion = area_ratio / quality.area;
  return quality;
}

}  // namespace applique
