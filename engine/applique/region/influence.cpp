#include "applique/region/influence.h"

#include <algorithm>
#include <array>

#include <Eigen/SparseCholesky>

#include "applique/base/error.h"

namespace applique {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

constexpr std::uint32_t none = ~0U;
// Opposite an angle of the contour that is not acute, a weight would be negative; at a needle, infinite.
constexpr double least_weight = 1e-9;
constexpr double largest_weight = 1e9;

/// The edges of the triangulation with their cotangent weights, once each.
struct WeightedEdge {
  std::uint32_t a, b;
  double weight;
};

std::vector<WeightedEdge> weighted_edges(const RegionTriangulation& mesh) {
  const auto half_cotangent = [&](std::size_t t, std::size_t k) {
    const auto& c = mesh.triangles[t];
    const Vec2 u = mesh.points[c[(k + 1) % 3]] - mesh.points[c[k]];
    const Vec2 v = mesh.points[c[(k + 2) % 3]] - mesh.points[c[k]];
    return 0.5 * dot(u, v) / std::max(cross(u, v), std::abs(u) * std::abs(v) / largest_weight);
  };
  std::vector<WeightedEdge> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t other = mesh.neighbours[t][k];
      if (other >= 0 && static_cast<std::size_t>(other) < t) continue;
      double weight = half_cotangent(t, k);
      if (other >= 0) {
        const auto& back = mesh.neighbours[other];
        weight += half_cotangent(other, std::find(back.begin(), back.end(), t) - back.begin());
      }
      const auto& c = mesh.triangles[t];
      edges.push_back({c[(k + 1) % 3], c[(k + 2) % 3], std::max(weight, least_weight)});
    }
  }
  return edges;
}

}  // namespace

InfluenceField::InfluenceField(const Region& region, std::span<const Vec2> features,
                               const FeatureGraph& graph, std::span<const std::uint32_t> group,
                               const InfluenceOptions& options) {
  APPLIQUE_ASSERT(!features.empty() && group.size() == features.size());
  groups_ = *std::max_element(group.begin(), group.end()) + 1;
  std::vector<FeaturePair> segments;
  for (const FeaturePair pair : graph.planar) {
    if (group[pair[0]] == group[pair[1]]) segments.push_back(pair);
  }
  mesh_ = triangulate_region(region, features, segments, {options.max_edge * region.diameter()});
  locator_ = RegionLocator(mesh_);

  std::vector<std::uint32_t> held(mesh_.points.size(), none);  // By point: the group that has it to itself.
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (const std::uint32_t point : mesh_.segments[s]) held[point] = group[segments[s][0]];
  }
  for (std::size_t i = 0; i < features.size(); ++i) held[mesh_.features[i]] = group[i];
  solve(held);
}

void InfluenceField::solve(const std::vector<std::uint32_t>& held) {
  std::vector<int> unknown(held.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == none) unknown[i] = count++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, groups_);
  for (const auto& [a, b, weight] : weighted_edges(mesh_)) {
    for (const auto& [i, j] : {std::pair(a, b), std::pair(b, a)}) {
      if (unknown[i] < 0) continue;
      entries.emplace_back(unknown[i], unknown[i], weight);
      if (unknown[j] >= 0) {
        entries.emplace_back(unknown[i], unknown[j], -weight);
      } else {
        right(unknown[i], held[j]) += weight;
      }
    }
  }
  Matrix laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Matrix> solver(laplacian);
  APPLIQUE_ASSERT(count == 0 || solver.info() == Eigen::Success);
  const Eigen::MatrixXd solution = count == 0 ? right : Eigen::MatrixXd(solver.solve(right));

  values_.assign(held.size() * groups_, 0);
  for (std::size_t i = 0; i < held.size(); ++i) {
    double* value = values_.data() + i * groups_;
    if (unknown[i] < 0) {
      value[held[i]] = 1;
      continue;
    }
    double sum = 0;
    for (std::uint32_t g = 0; g < groups_; ++g) {  // The sum is 1, and nothing negative, but for rounding.
      value[g] = std::max(0.0, solution(unknown[i], g));
      sum += value[g];
    }
    for (std::uint32_t g = 0; g < groups_; ++g) value[g] /= sum;
  }
}

void InfluenceField::at(Vec2 z, std::span<double> influence) const {
  APPLIQUE_ASSERT(influence.size() == groups_);
  const RegionLocation location = locator_.locate(z);
  std::fill(influence.begin(), influence.end(), 0.0);
  for (int k = 0; k < 3; ++k) {
    const std::span<const double> corner = at_point(mesh_.triangles[location.triangle][k]);
    for (std::uint32_t g = 0; g < groups_; ++g) influence[g] += location.barycentric[k] * corner[g];
  }
}

std::vector<std::uint32_t> InfluenceField::segment_labels() const {
  std::vector<std::uint32_t> labels;
  std::vector<double> sum(groups_);
  for (const auto& triangle : mesh_.triangles) {
    std::fill(sum.begin(), sum.end(), 0.0);
    for (const std::uint32_t point : triangle) {
      for (std::uint32_t g = 0; g < groups_; ++g) sum[g] += at_point(point)[g];
    }
    labels.push_back(static_cast<std::uint32_t>(std::max_element(sum.begin(), sum.end()) - sum.begin()));
  }
  return labels;
}

}  // namespace applique
