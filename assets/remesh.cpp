#include "remesh.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "parallel.h"

namespace applique::assets {
namespace {

using Index = std::uint32_t;

class Remesher {
 public:
  Remesher(const Mesh& mesh, const DistanceField& field, const RemeshOptions& options)
      : field_(field), options_(options), positions_(mesh.positions), triangles_(mesh.triangles) {
    around_.resize(positions_.size());
    for (Index t = 0; t < triangles_.size(); ++t)
      for (const Index v : triangles_[t]) around_[v].push_back(t);
  }

  /// `last`: vertices go onto the surface exactly.
  void round(bool measure, bool last) {
    if (measure) measure_sizes();
    split_long();
    collapse_short();
    flip_edges();
    smooth(last ? 1e-7 : 1e-4);
  }

  [[nodiscard]] Mesh mesh() const {
    Mesh out;
    std::vector<Index> number(positions_.size(), 0);
    for (Index v = 0; v < positions_.size(); ++v) {
      if (around_[v].empty()) continue;
      number[v] = static_cast<Index>(out.positions.size());
      out.positions.push_back(positions_[v]);
    }
    for (const Triangle& t : triangles_)
      if (t[0] != t[1]) out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    return out;
  }

 private:
  // A deleted triangle has three equal corners; a deleted vertex has no triangles.

  [[nodiscard]] bool alive(Index t) const { return triangles_[t][0] != triangles_[t][1]; }

  [[nodiscard]] Vec3 normal(const Triangle& t) const {
    return (positions_[t[1]] - positions_[t[0]]).cross(positions_[t[2]] - positions_[t[0]]);
  }

  /// The triangle with the side a to b, and its third corner.
  [[nodiscard]] bool find(Index a, Index b, Index& triangle, Index& opposite) const {
    for (const Index t : around_[a])
      for (int i = 0; i < 3; ++i)
        if (triangles_[t][i] == a && triangles_[t][(i + 1) % 3] == b) {
          triangle = t;
          opposite = triangles_[t][(i + 2) % 3];
          return true;
        }
    return false;
  }

  [[nodiscard]] std::vector<Index> neighbours(Index v) const {
    std::vector<Index> out;
    for (const Index t : around_[v])
      for (int i = 0; i < 3; ++i)
        if (triangles_[t][i] == v) out.push_back(triangles_[t][(i + 1) % 3]);
    return out;
  }

  [[nodiscard]] double length(Index a, Index b) const { return (positions_[a] - positions_[b]).norm(); }
  [[nodiscard]] double target(Index a, Index b) const { return std::min(size_[a], size_[b]); }

  void replace(Index triangle, Index from, Index to) {
    for (Index& v : triangles_[triangle])
      if (v == from) v = to;
  }
  void drop(Index vertex, Index triangle) { std::erase(around_[vertex], triangle); }

  template <class Visit>
  void each_edge(const Visit& visit) {
    const std::size_t count = triangles_.size();
    for (Index t = 0; t < count; ++t)
      for (int i = 0; i < 3; ++i) {
        if (!alive(t)) break;
        const Index a = triangles_[t][i];
        const Index b = triangles_[t][(i + 1) % 3];
        if (a < b) visit(a, b);
      }
  }

  /// Target edge lengths at the vertices, from the larger principal curvature: of a distance function, the
  /// second derivatives within the tangent plane.
  void measure_sizes() {
    size_.assign(positions_.size(), options_.coarsest);
    each_vertex([&](Index v) {
      const Vec3 p = positions_[v];
      const Vec3 n = field_normal(field_, p);
      const double finest = options_.finest(p);
      const double step = 0.7 * finest;
      const Vec3 a = step * n.unitOrthogonal();
      const Vec3 b = n.cross(a);
      const Vec3 c = std::sqrt(0.5) * (a + b);
      const double middle = 2 * field_(p);
      const double aa = (field_(p + a) + field_(p - a) - middle) / (step * step);
      const double bb = (field_(p + b) + field_(p - b) - middle) / (step * step);
      const double cc = (field_(p + c) + field_(p - c) - middle) / (step * step);
      const double ab = cc - 0.5 * (aa + bb);
      const double curvature = 0.5 * std::abs(aa + bb) + std::hypot(0.5 * (aa - bb), ab);
      size_[v] = std::clamp(options_.fineness / std::max(curvature, 1e-9), finest, options_.coarsest);
    });
    for (int pass = 0; pass < 12; ++pass)
      each_edge([&](Index a, Index b) {
        const double slack = options_.grading * length(a, b);
        size_[a] = std::min(size_[a], size_[b] + slack);
        size_[b] = std::min(size_[b], size_[a] + slack);
      });
  }

  template <class Visit>
  void each_vertex(const Visit& visit) {
    const auto count = static_cast<int>(positions_.size());
    parallel_for((count + 255) / 256, [&](int block) {
      for (int v = 256 * block; v < std::min(256 * (block + 1), count); ++v)
        if (!around_[v].empty()) visit(static_cast<Index>(v));
    });
  }

  void split_long() {
    each_edge([&](Index a, Index b) {
      if (length(a, b) <= 4.0 / 3 * target(a, b)) return;
      Index left = 0;
      Index right = 0;
      Index c = 0;
      Index d = 0;
      if (!find(a, b, left, c) || !find(b, a, right, d)) return;
      const auto m = static_cast<Index>(positions_.size());
      positions_.push_back(project_to_surface(field_, 0.5 * (positions_[a] + positions_[b]), 1e-4));
      size_.push_back(target(a, b));
      // a b c becomes a m c and m b c; b a d becomes m a d and b m d.
      const auto left_new = static_cast<Index>(triangles_.size());
      triangles_.push_back({m, b, c});
      const Index right_new = left_new + 1;
      triangles_.push_back({b, m, d});
      replace(left, b, m);
      replace(right, b, m);
      drop(b, left);
      drop(b, right);
      around_[b].insert(around_[b].end(), {left_new, right_new});
      around_[c].push_back(left_new);
      around_[d].push_back(right_new);
      around_.push_back({left, right, left_new, right_new});
    });
  }

  void collapse_short() {
    each_edge([&](Index a, Index b) {
      if (length(a, b) >= 0.8 * target(a, b)) return;
      Index left = 0;
      Index right = 0;
      Index c = 0;
      Index d = 0;
      if (!find(a, b, left, c) || !find(b, a, right, d)) return;
      const std::vector<Index> near_a = neighbours(a);
      const std::vector<Index> near_b = neighbours(b);
      const auto shared = std::count_if(near_a.begin(), near_a.end(), [&](Index v) {
        return std::find(near_b.begin(), near_b.end(), v) != near_b.end();
      });
      if (shared != 2 || near_a.size() + near_b.size() < 9) return;
      if (around_[c].size() <= 4 || around_[d].size() <= 4) return;
      // b moves onto a: no edge may become long, no triangle may turn over.
      for (const Index v : near_b)
        if (v != a && length(a, v) > 4.0 / 3 * target(a, v)) return;
      for (const Index t : around_[b]) {
        if (t == left || t == right) continue;
        Triangle moved = triangles_[t];
        for (Index& v : moved)
          if (v == b) v = a;
        const Vec3 before = normal(triangles_[t]);
        const Vec3 after = normal(moved);
        if (after.dot(before) < 0.5 * after.norm() * before.norm()) return;
      }
      for (const Index t : around_[b])
        if (t != left && t != right) {
          replace(t, b, a);
          around_[a].push_back(t);
        }
      for (const Index t : {left, right}) {
        for (const Index v : triangles_[t])
          if (v != b) drop(v, t);
        triangles_[t] = {0, 0, 0};
      }
      around_[b].clear();
    });
  }

  void flip_edges() {
    each_edge([&](Index a, Index b) {
      Index left = 0;
      Index right = 0;
      Index c = 0;
      Index d = 0;
      if (!find(a, b, left, c) || !find(b, a, right, d)) return;
      Index unused = 0;
      Index other = 0;
      if (c == d || find(c, d, unused, other) || find(d, c, unused, other)) return;
      const auto off = [&](Index v, int change) {
        return std::abs(static_cast<int>(around_[v].size()) + change - 6);
      };
      const int before = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
      const int after = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
      if (after >= before || around_[a].size() <= 4 || around_[b].size() <= 4) return;
      const Triangle first{a, d, c};
      const Triangle second{d, b, c};
      const Vec3 old = normal(triangles_[left]).normalized() + normal(triangles_[right]).normalized();
      const Vec3 n1 = normal(first);
      const Vec3 n2 = normal(second);
      if (n1.dot(old) < 1.4 * n1.norm() || n2.dot(old) < 1.4 * n2.norm()) return;
      // Not across a fold that the edge follows, and not into slivers.
      const double shortest = std::min(n1.norm(), n2.norm());
      if (shortest < 0.2 * length(c, d) * length(c, d)) return;
      triangles_[left] = first;
      triangles_[right] = second;
      drop(b, left);
      drop(a, right);
      around_[d].push_back(left);
      around_[c].push_back(right);
    });
  }

  void smooth(double tolerance) {
    std::vector<Vec3> moved = positions_;
    each_vertex([&](Index v) {
      // Towards the mean of the triangles' centres, weighted by area relative to the size wanted there.
      Vec3 sum = Vec3::Zero();
      double weight = 0;
      for (const Index t : around_[v]) {
        const Triangle& corners = triangles_[t];
        double size = 0;
        Vec3 centre = Vec3::Zero();
        for (const Index c : corners) {
          size += size_[c] / 3;
          centre += positions_[c] / 3;
        }
        const double w = normal(corners).norm() / (size * size);
        sum += w * centre;
        weight += w;
      }
      if (weight <= 0) return;
      const Vec3 n = field_normal(field_, positions_[v]);
      const Vec3 offset = sum / weight - positions_[v];
      moved[v] = project_to_surface(field_, positions_[v] + 0.8 * (offset - offset.dot(n) * n), tolerance);
    });
    positions_ = std::move(moved);
  }

  const DistanceField& field_;
  RemeshOptions options_;
  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<Index>> around_;  // the triangles around each vertex
  std::vector<double> size_;                // target edge length at each vertex
};

}  // namespace

Mesh remesh(const Mesh& mesh, const DistanceField& field, const RemeshOptions& options) {
  Remesher remesher(mesh, field, options);
  for (int i = 0; i < options.rounds; ++i) remesher.round(i % 2 == 0, i + 1 == options.rounds);
  Mesh out = remesher.mesh();
  out.normals.resize(out.positions.size());
  parallel_for(static_cast<int>(out.positions.size() + 255) / 256, [&](int block) {
    for (std::size_t v = 256UL * block; v < std::min<std::size_t>(out.positions.size(), 256UL * (block + 1));
         ++v)
      out.normals[v] = field_normal(field, out.positions[v]);
  });
  return out;
}

}  // namespace applique::assets
