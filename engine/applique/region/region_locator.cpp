#include "applique/region/region_locator.h"

#include <algorithm>
#include <limits>

namespace applique {
namespace {

constexpr std::size_t leaves_per_box = 4;

/// Barycentric coordinates of the point of the segment from a to b that is nearest to z, the third one 0.
std::array<double, 2> nearest_on_segment(Vec2 z, Vec2 a, Vec2 b) {
  const double t = std::clamp(dot(z - a, b - a) / std::norm(b - a), 0.0, 1.0);
  return {1 - t, t};
}

/// Those of the point of the triangle that is nearest to z.
std::array<double, 3> nearest_in_triangle(Vec2 z, const std::array<Vec2, 3>& corner) {
  std::array<double, 3> areas;  // Twice; of the triangles that z makes with the edges.
  for (int k = 0; k < 3; ++k) areas[k] = cross(corner[(k + 1) % 3] - z, corner[(k + 2) % 3] - z);
  const double sum = areas[0] + areas[1] + areas[2];
  if (areas[0] >= 0 && areas[1] >= 0 && areas[2] >= 0 && sum > 0) {
    return {areas[0] / sum, areas[1] / sum, areas[2] / sum};
  }
  std::array<double, 3> nearest{};
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (areas[k] > 0) continue;  // The nearest point lies on an edge that z is beyond.
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const auto [wa, wb] = nearest_on_segment(z, corner[a], corner[b]);
    const double distance = std::norm(z - wa * corner[a] - wb * corner[b]);
    if (distance >= least) continue;
    least = distance;
    nearest = {};
    nearest[a] = wa;
    nearest[b] = wb;
  }
  return nearest;
}

}  // namespace

double RegionLocator::Box::squared_distance(Vec2 z) const {
  const double x = std::max({low.real() - z.real(), 0.0, z.real() - high.real()});
  const double y = std::max({low.imag() - z.imag(), 0.0, z.imag() - high.imag()});
  return x * x + y * y;
}

RegionLocator::RegionLocator(const RegionTriangulation& mesh) {
  leaves_.reserve(mesh.triangles.size());
  for (const auto& c : mesh.triangles) {
    leaves_.push_back({{mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]},
                       static_cast<std::uint32_t>(leaves_.size())});
  }
  build(0, 0, leaves_.size());
}

void RegionLocator::build(std::size_t node, std::size_t begin, std::size_t end) {
  if (node >= boxes_.size()) boxes_.resize(node + 1);
  Vec2 low = leaves_[begin].corners[0], high = low;
  for (std::size_t i = begin; i < end; ++i) {
    for (const Vec2 z : leaves_[i].corners) {
      low = {std::min(low.real(), z.real()), std::min(low.imag(), z.imag())};
      high = {std::max(high.real(), z.real()), std::max(high.imag(), z.imag())};
    }
  }
  boxes_[node] = {low, high};
  if (end - begin <= leaves_per_box) return;
  const bool wide = high.real() - low.real() > high.imag() - low.imag();
  const auto key = [&](const Leaf& leaf) {
    const Vec2 sum = leaf.corners[0] + leaf.corners[1] + leaf.corners[2];
    return wide ? sum.real() : sum.imag();
  };
  const std::size_t middle = (begin + end) / 2;
  std::nth_element(leaves_.begin() + begin, leaves_.begin() + middle, leaves_.begin() + end,
                   [&](const Leaf& a, const Leaf& b) {
                     return std::pair(key(a), a.triangle) < std::pair(key(b), b.triangle);
                   });
  build(2 * node + 1, begin, middle);
  build(2 * node + 2, middle, end);
}

RegionLocation RegionLocator::locate(Vec2 z) const {
  struct Node {
    std::size_t number, begin, end;
    double distance;  // Squared.
  };
  std::array<Node, 64> open;  // One a level, and a level more, are open at most.
  std::size_t count = 0;
  open[count++] = {0, 0, leaves_.size(), 0};
  RegionLocation found{};
  double least = std::numeric_limits<double>::infinity();
  while (count > 0) {
    const auto [number, begin, end, distance] = open[--count];
    if (distance >= least) continue;
    if (end - begin <= leaves_per_box) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto& [corners, triangle] = leaves_[i];
        const auto w = nearest_in_triangle(z, corners);
        const bool inside = w[0] > 0 && w[1] > 0 && w[2] > 0;
        const double gap =
            inside ? 0 : std::norm(z - w[0] * corners[0] - w[1] * corners[1] - w[2] * corners[2]);
        if (gap >= least) continue;
        least = gap;
        found = {triangle, w};
      }
      continue;
    }
    const std::size_t middle = (begin + end) / 2, child = 2 * number + 1;
    Node near = {child, begin, middle, boxes_[child].squared_distance(z)};
    Node far = {child + 1, middle, end, boxes_[child + 1].squared_distance(z)};
    if (far.distance < near.distance) std::swap(near, far);
    if (far.distance < least) open[count++] = far;
    if (near.distance < least) open[count++] = near;
  }
  return found;
}

}  // namespace applique
