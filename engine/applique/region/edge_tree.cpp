#include "applique/region/edge_tree.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace applique {
namespace {

constexpr std::size_t edges_a_leaf = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

double squared_distance_to_edge(Vec2 z, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double t = std::clamp(dot(z - a, d) / std::norm(d), 0.0, 1.0);
  return std::norm(z - a - t * d);
}

}  // namespace

double EdgeTree::Box::squared_distance(Vec2 z) const {
  const double dx = std::max({low.real() - z.real(), 0.0, z.real() - high.real()});
  const double dy = std::max({low.imag() - z.imag(), 0.0, z.imag() - high.imag()});
  return dx * dx + dy * dy;
}

EdgeTree::EdgeTree(const std::vector<Vec2>& polygon) : ends_(polygon) {
  ends_.push_back(polygon[0]);
  leaves_ = std::bit_ceil((polygon.size() + edges_a_leaf - 1) / edges_a_leaf);
  boxes_.assign(2 * leaves_ - 1, {{infinity, infinity}, {-infinity, -infinity}});
  const auto add = [](Box& box, Vec2 low, Vec2 high) {
    box.low = {std::min(box.low.real(), low.real()), std::min(box.low.imag(), low.imag())};
    box.high = {std::max(box.high.real(), high.real()), std::max(box.high.imag(), high.imag())};
  };
  for (std::size_t e = 0; e < polygon.size(); ++e) {
    Box& leaf = boxes_[leaves_ - 1 + e / edges_a_leaf];
    add(leaf, ends_[e], ends_[e]);
    add(leaf, ends_[e + 1], ends_[e + 1]);
  }
  for (std::size_t k = boxes_.size() - 1; k > 0; --k) add(boxes_[(k - 1) / 2], boxes_[k].low, boxes_[k].high);
}

double EdgeTree::squared_distance(Vec2 z) const {
  double best = infinity;
  search(z, 0, best);
  return best;
}

void EdgeTree::search(Vec2 z, std::size_t node, double& best) const {
  if (node >= leaves_ - 1) {
    const std::size_t first = (node - (leaves_ - 1)) * edges_a_leaf;
    const std::size_t last = std::min(first + edges_a_leaf, ends_.size() - 1);
    for (std::size_t e = first; e < last; ++e) {
      best = std::min(best, squared_distance_to_edge(z, ends_[e], ends_[e + 1]));
    }
    return;
  }
  std::size_t near = 2 * node + 1, far = near + 1;
  double near_distance = boxes_[near].squared_distance(z), far_distance = boxes_[far].squared_distance(z);
  if (far_distance < near_distance) {
    std::swap(near, far);
    std::swap(near_distance, far_distance);
  }
  if (near_distance < best) search(z, near, best);
  if (far_distance < best) search(z, far, best);
}

}  // namespace applique
