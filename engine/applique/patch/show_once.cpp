#include "applique/patch/show_once.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "applique/base/convex_clip.h"
#include "applique/base/predicates.h"
#include "applique/base/triangle_grid.h"
#include "applique/embed/self_overlap.h"
#include "applique/quality/map_quality.h"

namespace applique {
namespace {

using Triangle = TriangleGrid::Triangle;

constexpr double no_area = 1e-9;  // of the region's

/// Whether an edge of `a` has all of `b` on its other side, or on it.
bool has_separating_edge(const Triangle& a, const Triangle& b) {
  for (int k = 0; k < 3; ++k) {
    const Vec2 from = a[k], to = a[(k + 1) % 3];
    if (std::all_of(b.begin(), b.end(), [&](Vec2 z) { return orientation(from, to, z) <= 0; })) return true;
  }
  return false;
}

/// Triangles of the plane, and whether what two of them share shows in the image.
class Overlaps {
 public:
  Overlaps(const Warp& warp, const Region& region) : warp_(warp), region_(region) {}

  bool operator()(const Triangle& a, const Triangle& b) const {
    if (!boxes_meet(a, b)) return false;
    if (has_separating_edge(a, b) || has_separating_edge(b, a)) return false;
    std::vector<Vec2> shared(a.begin(), a.end());
    for (int k = 0; k < 3; ++k) shared = clip_left_of(shared, b[k], b[(k + 1) % 3]);
    for (Vec2& z : shared) z = warp_(z);
    double area = 0;
    for (std::size_t i = 2; i < shared.size(); ++i) {
      const Triangle part = {shared[0], shared[i - 1], shared[i]};
      if (orientation(part[0], part[1], part[2]) > 0) area += area_in_region(region_, part);
    }
    return area > no_area * region_.area();
  }

 private:
  static bool boxes_meet(const Triangle& a, const Triangle& b) {
    const auto apart = [&](const auto& along) {
      const auto [least_a, most_a] = std::minmax({along(a[0]), along(a[1]), along(a[2])});
      const auto [least_b, most_b] = std::minmax({along(b[0]), along(b[1]), along(b[2])});
      return most_a < least_b || most_b < least_a;
    };
    return !apart([](Vec2 z) { return z.real(); }) && !apart([](Vec2 z) { return z.imag(); });
  }

  const Warp& warp_;
  const Region& region_;
};

}  // namespace

double show_once(const ImmersedDisc& disc, const PatchPoints& points, const Warp& warp, const Region& region,
                 const std::vector<PatchFaceId>& feature_faces, IdVector<PatchFaceId, char>& shown) {
  if (is_injective(disc, points, shown)) return 0;
  const auto corners = [&](PatchFaceId q) {
    const auto& v = disc.faces()[q].vertices;
    return Triangle{points[v[0]].plane, points[v[1]].plane, points[v[2]].plane};
  };
  const auto middle = [&](PatchFaceId q) {
    const auto& v = disc.faces()[q].vertices;
    return (points[v[0]].image + points[v[1]].image + points[v[2]].image) / 3.0;
  };
  std::vector<Triangle> triangles;
  for (PatchFaceId q : ids<PatchFaceId>(shown.size()))
    if (shown[q]) triangles.push_back(corners(q));
  TriangleGrid grid(triangles);
  const Overlaps overlap(warp, region);

  using Reached = std::pair<double, PatchFaceId>;  // how far from a feature, in the image
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
  for (const PatchFaceId q : feature_faces) front.emplace(0, q);
  IdVector<PatchFaceId, char> once(shown.size(), false), tried(shown.size(), false);
  while (!front.empty()) {
    const auto [way, q] = front.top();
    front.pop();
    if (tried[q] || !shown[q]) continue;
    tried[q] = true;
    const Triangle triangle = corners(q);
    const bool turned = orientation(triangle[0], triangle[1], triangle[2]) <= 0;  // is told as such
    const auto lies_over = [&](std::uint32_t other) {
      return overlap(triangle, corners(PatchFaceId(other)));
    };
    if (way > 0 && !turned && grid.any_near(triangle, lies_over)) continue;
    once[q] = true;
    if (!turned) grid.insert(q.value, triangle);
    for (const PatchFaceId next : disc.faces()[q].neighbours)
      if (next.valid()) front.emplace(way + std::abs(middle(next) - middle(q)), next);
  }
  double left_out = 0;
  for (PatchFaceId q : ids<PatchFaceId>(shown.size())) {
    if (!shown[q] || once[q]) continue;
    const auto& v = disc.faces()[q].vertices;
    const Triangle image = {points[v[0]].image, points[v[1]].image, points[v[2]].image};
    if (orientation(image[0], image[1], image[2]) > 0) left_out += area_in_region(region, image);
  }
  shown = std::move(once);
  return left_out / region.area();
}

}  // namespace applique
