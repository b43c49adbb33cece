#include "applique/paper/region_walk.h"

#include <algorithm>

#include "applique/base/predicates.h"
#include "applique/paper/continue_map.h"

namespace applique {
namespace {

/// Where a walk ended: in the triangle that holds its goal, or before the region's contour.
struct Arrival {
  std::uint32_t triangle;
  bool inside;
};

class Walker {
 public:
  explicit Walker(const WarpedRegion& region) : region_(region) {}

  /// From a point of triangle `at` straight to another point.
  [[nodiscard]] Arrival walk(std::uint32_t at, Vec2 from, Vec2 to) const {
    std::uint32_t came_from = at;
    // A straight walk passes a triangle once; the bound is for places where the warp has folded.
    for (std::size_t step = 0; step < region_.image->triangles.size(); ++step) {
      if (is_wall(at)) return {came_from, false};
      const int exit = exit_edge(at, came_from, from, to);
      if (exit < 0) return {at, true};
      const std::int32_t next = region_.image->neighbours[at][exit];
      if (next < 0) return {at, false};
      came_from = at;
      at = static_cast<std::uint32_t>(next);
    }
    return {at, false};
  }

  /// The image of z under the map of a triangle.
  [[nodiscard]] Vec2 to_image(std::uint32_t triangle, Vec2 z) const {
    const auto& t = region_.image->triangles[triangle];
    const Vec2 a = region_.plane[t[0]], b = region_.plane[t[1]] - a, c = region_.plane[t[2]] - a;
    const double s = cross(z - a, c) / cross(b, c), u = cross(b, z - a) / cross(b, c);
    const auto& points = region_.image->points;
    return points[t[0]] + s * (points[t[1]] - points[t[0]]) + u * (points[t[2]] - points[t[0]]);
  }

  [[nodiscard]] bool is_wall(std::uint32_t triangle) const {
    const auto [a, b, c] = corners(triangle);
    return orientation(a, b, c) <= 0;
  }

 private:
  [[nodiscard]] std::array<Vec2, 3> corners(std::uint32_t triangle) const {
    const auto& t = region_.image->triangles[triangle];
    return {region_.plane[t[0]], region_.plane[t[1]], region_.plane[t[2]]};
  }

  /// The edge that the way to `to` leaves the triangle by; -1 when `to` lies in it.
  [[nodiscard]] int exit_edge(std::uint32_t at, std::uint32_t came_from, Vec2 from, Vec2 to) const {
    const auto corner = corners(at);
    int exit = -1;
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = corner[(k + 1) % 3], b = corner[(k + 2) % 3];
      if (orientation(a, b, to) >= 0) continue;
      if (came_from != at && region_.image->neighbours[at][k] == static_cast<std::int32_t>(came_from))
        continue;
      exit = k;
      if (orientation(from, to, a) <= 0 && orientation(from, to, b) >= 0) break;
    }
    return exit;
  }

  const WarpedRegion& region_;
};

/// By point of the triangulation that is a feature, the triangles round it.
std::vector<std::vector<std::uint32_t>> triangles_at_features(const RegionTriangulation& region) {
  std::vector<std::vector<std::uint32_t>> found(region.features.size());
  for (std::uint32_t t = 0; t < region.triangles.size(); ++t)
    for (std::size_t k = 0; k < region.features.size(); ++k)
      if (std::find(region.triangles[t].begin(), region.triangles[t].end(), region.features[k]) !=
          region.triangles[t].end())
        found[k].push_back(t);
  return found;
}

}  // namespace

LocatedPatch locate_patch(const ImmersedDisc& disc, const std::vector<PatchVertexId>& features,
                          const std::vector<Vec2>& plane, const WarpedRegion& region,
                          std::optional<std::uint32_t> first) {
  const std::size_t count = disc.vertex_count();
  const Walker walker(region);
  LocatedPatch located{IdVector<PatchVertexId, char>(count, false), IdVector<PatchVertexId, Vec2>(count), {}};
  // By vertex, the triangles that it can be left from: one, but all round it for a feature.
  IdVector<PatchVertexId, std::vector<std::uint32_t>> homes(count);
  std::vector<PatchVertexId> stack;
  const auto enter = [&](PatchVertexId v, std::vector<std::uint32_t> home, Vec2 image) {
    located.inside[v] = true;
    located.image[v] = image;
    homes[v] = std::move(home);
    stack.push_back(v);
  };
  const auto at_features = triangles_at_features(*region.image);
  const auto enter_feature = [&](std::uint32_t k) {
    if (!located.inside[features[k]])
      enter(features[k], at_features[k], region.image->points[region.image->features[k]]);
  };
  for (std::uint32_t k = 0; k < features.size(); ++k)
    if (!first || *first == k) enter_feature(k);

  IdVector<PatchVertexId, Vec2> beyond(count, 0.0);  // sums of continued image points
  IdVector<PatchVertexId, int> leads(count, 0);
  while (!stack.empty()) {
    const PatchVertexId v = stack.back();
    stack.pop_back();
    for (PatchFaceId q : disc.fan(v))
      for (PatchVertexId w : disc.faces()[q].vertices) {
        if (located.inside[w]) continue;
        for (std::uint32_t home : homes[v]) {
          if (walker.is_wall(home)) continue;
          const auto [triangle, inside] = walker.walk(home, plane[v.value], plane[w.value]);
          const Vec2 image = walker.to_image(triangle, plane[w.value]);
          if (inside) {
            const auto feature = std::find(features.begin(), features.end(), w);
            if (feature == features.end())
              enter(w, {triangle}, image);
            else
              enter_feature(static_cast<std::uint32_t>(feature - features.begin()));
            break;
          }
          beyond[w] += image;
          ++leads[w];
        }
      }
  }
  for (std::uint32_t k = 0; k < features.size(); ++k)
    if (!located.inside[features[k]]) located.missed.push_back(k);

  std::vector<char> placed(count, false);
  for (PatchVertexId v : ids<PatchVertexId>(count)) {
    placed[v.value] = located.inside[v] || leads[v] > 0;
    if (!located.inside[v] && leads[v] > 0) located.image[v] = beyond[v] / static_cast<double>(leads[v]);
  }
  continue_map(disc, placed, located.image.raw());
  return located;
}

}  // namespace applique
