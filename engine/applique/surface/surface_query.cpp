#include "applique/surface/surface_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace applique {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr int bins = 16;

struct Box {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void add(const Box& box) {
    lower = lower.cwiseMin(box.lower);
    upper = upper.cwiseMax(box.upper);
  }
  /// Half the surface; 0 for an empty box.
  [[nodiscard]] double half_area() const {
    const Vec3 d = (upper - lower).cwiseMax(0.0);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
  [[nodiscard]] double squared_distance(const Vec3& p) const {
    return (lower - p).cwiseMax(p - upper).cwiseMax(0.0).squaredNorm();
  }
};

/// A node of the hierarchy: a leaf, or a node that no query has visited yet, has `count` faces from `first`
/// on; another has its children at `first` and `first + 1`.
struct Node {
  Box box;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// The point of a triangle nearest to p, as barycentrics (Ericson, Real-Time Collision Detection, 2005,
/// §5.1.5).
std::array<double, 3> nearest_in_triangle(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0];
  const Vec3 ac = t[2] - t[0];
  const Vec3 ap = p - t[0];
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - t[1];
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) {
    const double s = d1 / (d1 - d3);
    return {1 - s, s, 0};
  }
  const Vec3 cp = p - t[2];
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) {
    const double s = d2 / (d2 - d6);
    return {1 - s, 0, s};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - s, s};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0};
  return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

/// A ray made ready for the watertight test of Woop, Benthin and Wald (Watertight Ray/Triangle Intersection,
/// 2013): sheared so that it runs along its largest axis; a ray through an edge hits at least one of its
/// faces.
struct Ray {
  Vec3 origin;
  Vec3 direction;
  Vec3 inverse;
  int kx = 0, ky = 1, kz = 2;
  double sx = 0, sy = 0, sz = 1;

  Ray(const Vec3& o, const Vec3& d) : origin(o), direction(d), inverse(d.cwiseInverse()) {
    direction.cwiseAbs().maxCoeff(&kz);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    sx = direction[kx] / direction[kz];
    sy = direction[ky] / direction[kz];
    sz = 1 / direction[kz];
  }
};

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  std::array<double, 3> barycentric = {};
};

std::optional<Hit> intersect(const Ray& ray, const std::array<Vec3, 3>& triangle) {
  std::array<std::array<double, 3>, 3> v;
  for (int i = 0; i < 3; ++i) {
    const Vec3 p = triangle[i] - ray.origin;
    v[i] = {p[ray.kx] - ray.sx * p[ray.kz], p[ray.ky] - ray.sy * p[ray.kz], ray.sz * p[ray.kz]};
  }
  const double a = v[2][0] * v[1][1] - v[2][1] * v[1][0];
  const double b = v[0][0] * v[2][1] - v[0][1] * v[2][0];
  const double c = v[1][0] * v[0][1] - v[1][1] * v[0][0];
  if ((a < 0 || b < 0 || c < 0) && (a > 0 || b > 0 || c > 0)) return std::nullopt;
  const double sum = a + b + c;
  if (sum == 0) return std::nullopt;
  const double t = (a * v[0][2] + b * v[1][2] + c * v[2][2]) / sum;
  if (!(t >= 0)) return std::nullopt;
  return Hit{t, {a / sum, b / sum, c / sum}};
}

/// Where the ray enters the box, or infinity.
double entry(const Ray& ray, const Box& box) {
  double near = 0;
  double far = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) {
      if (ray.origin[k] < box.lower[k] || ray.origin[k] > box.upper[k])
        return std::numeric_limits<double>::infinity();
      continue;
    }
    const double t0 = (box.lower[k] - ray.origin[k]) * ray.inverse[k];
    const double t1 = (box.upper[k] - ray.origin[k]) * ray.inverse[k];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  // Rounding must not lose a triangle that lies in a side of the box.
  return near <= far * (1 + 1e-12) ? near : std::numeric_limits<double>::infinity();
}

}  // namespace

struct SurfaceQuery::Tree {
  std::vector<Node> nodes;
  std::vector<std::uint32_t> order;  ///< Faces, each node's own in a row.
  std::vector<Box> boxes;            ///< By face.

  explicit Tree(const SurfaceMesh& mesh) : order(mesh.faces.size()), boxes(mesh.faces.size()) {
    for (const FaceId f : ids<FaceId>(mesh.faces.size()))
      for (const Vec3& p : mesh.corners(f)) boxes[f.value].add(p);
    std::iota(order.begin(), order.end(), 0U);
    add_node(0, static_cast<std::uint32_t>(order.size()));
  }

  /// A node that is a leaf or has children: it is divided when it is first visited.
  const Node& visit(std::uint32_t index) {
    if (nodes[index].count > leaf_size) split(index);
    return nodes[index];
  }

 private:
  void add_node(std::uint32_t first, std::uint32_t count) {
    Box box;
    for (std::uint32_t i = first; i < first + count; ++i) box.add(boxes[order[i]]);
    nodes.push_back({box, first, count});
  }

  /// Divides the node's faces where the binned surface area heuristic is least (Wald 2007).
  void split(std::uint32_t index) {
    const std::uint32_t first = nodes[index].first;
    const std::uint32_t count = nodes[index].count;
    Box centres;
    for (std::uint32_t i = first; i < first + count; ++i) centres.add(centre(boxes[order[i]]));
    int axis = 0;
    const double extent = (centres.upper - centres.lower).maxCoeff(&axis);
    std::uint32_t left = count / 2;
    if (extent > 0) {
      const auto bin_of = [&](std::uint32_t f) {
        const double x = (centre(boxes[f])[axis] - centres.lower[axis]) / extent;
        return std::min(bins - 1, static_cast<int>(x * bins));
      };
      const int border = best_border(first, count, bin_of);
      const auto begin = order.begin() + first;
      left = static_cast<std::uint32_t>(
          std::partition(begin, begin + count, [&](std::uint32_t f) { return bin_of(f) < border; }) - begin);
      if (left == 0 || left == count) left = count / 2;
    }
    nodes[index].first = static_cast<std::uint32_t>(nodes.size());
    nodes[index].count = 0;
    add_node(first, left);
    add_node(first + left, count - left);
  }

  /// Faces in bins below the result go left.
  template <class BinOf>
  [[nodiscard]] int best_border(std::uint32_t first, std::uint32_t count, BinOf bin_of) const {
    std::array<Box, bins> box;
    std::array<std::uint32_t, bins> number = {};
    for (std::uint32_t i = first; i < first + count; ++i) {
      const int bin = bin_of(order[i]);
      box[bin].add(boxes[order[i]]);
      ++number[bin];
    }
    std::array<double, bins> right_cost = {};
    Box right;
    std::uint32_t right_count = 0;
    for (int k = bins - 1; k > 0; --k) {
      right.add(box[k]);
      right_count += number[k];
      right_cost[k] = right_count == 0 ? 0 : right.half_area() * right_count;
    }
    Box left;
    std::uint32_t left_count = 0;
    int best = bins / 2;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int k = 1; k < bins; ++k) {
      left.add(box[k - 1]);
      left_count += number[k - 1];
      if (left_count == 0 || left_count == count) continue;
      const double cost = left.half_area() * left_count + right_cost[k];
      if (cost < best_cost) {
        best_cost = cost;
        best = k;
      }
    }
    return best;
  }

  static Vec3 centre(const Box& box) { return 0.5 * (box.lower + box.upper); }
};

SurfaceQuery::SurfaceQuery(const SurfaceMesh& mesh) : mesh_(&mesh), tree_(std::make_unique<Tree>(mesh)) {}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

SurfacePoint SurfaceQuery::nearest(const Vec3& position) const {
  APPLIQUE_ASSERT(!mesh_->faces.empty());
  SurfacePoint best;
  double best_distance = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::uint32_t>> stack = {{0.0, 0}};
  while (!stack.empty()) {
    const auto [distance, index] = stack.back();
    stack.pop_back();
    if (distance > best_distance) continue;
    const Node& node = tree_->visit(index);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const FaceId f(tree_->order[i]);
      const auto corners = mesh_->corners(f);
      const auto weights = nearest_in_triangle(corners, position);
      const Vec3 point = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
      const double d = (point - position).squaredNorm();
      if (d < best_distance || (d == best_distance && f.value < best.face.value)) {
        best_distance = d;
        best = {f, weights};
      }
    }
    if (node.count != 0) continue;
    std::pair<double, std::uint32_t> near = {tree_->nodes[node.first].box.squared_distance(position),
                                             node.first};
    std::pair<double, std::uint32_t> far = {tree_->nodes[node.first + 1].box.squared_distance(position),
                                            node.first + 1};
    if (near.first > far.first) std::swap(near, far);
    stack.push_back(far);
    stack.push_back(near);
  }
  return best;
}

std::optional<SurfacePoint> SurfaceQuery::first_hit(const Vec3& origin, const Vec3& direction) const {
  if (mesh_->faces.empty()) return std::nullopt;
  const Ray ray(origin, direction);
  SurfacePoint best;
  double best_t = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::uint32_t>> stack = {{entry(ray, tree_->nodes[0].box), 0}};
  while (!stack.empty()) {
    const auto [t, index] = stack.back();
    stack.pop_back();
    if (t > best_t || std::isinf(t)) continue;
    const Node& node = tree_->visit(index);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const FaceId f(tree_->order[i]);
      const auto hit = intersect(ray, mesh_->corners(f));
      if (hit && (hit->t < best_t || (hit->t == best_t && f.value < best.face.value))) {
        best_t = hit->t;
        best = {f, hit->barycentric};
      }
    }
    if (node.count != 0) continue;
    std::pair<double, std::uint32_t> near = {entry(ray, tree_->nodes[node.first].box), node.first};
    std::pair<double, std::uint32_t> far = {entry(ray, tree_->nodes[node.first + 1].box), node.first + 1};
    if (near.first > far.first) std::swap(near, far);
    stack.push_back(far);
    stack.push_back(near);
  }
  if (!best.face.valid()) return std::nullopt;
  return best;
}

}  // namespace applique
