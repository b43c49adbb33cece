#include "applique/paper/feature_groups.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

#include "applique/base/predicates.h"

namespace applique {
namespace {

constexpr std::uint32_t none = ImageTriangulation::none;

/// Whether the segment from a to b and the closed triangle share more than a point.
bool crosses(Vec2 a, Vec2 b, const std::array<Vec2, 3>& triangle) {
  double enter = 0, leave = 1;
  for (int k = 0; k < 3; ++k) {
    const Vec2 from = triangle[k], edge = triangle[(k + 1) % 3] - from;
    const double at_a = cross(edge, a - from), at_b = cross(edge, b - from);
    if (orientation(from, from + edge, a) < 0 && orientation(from, from + edge, b) < 0) return false;
    if (at_a < 0) enter = std::max(enter, at_a / (at_a - at_b));
    if (at_b < 0) leave = std::min(leave, at_a / (at_a - at_b));
  }
  return leave - enter > 1e-9;
}

double area_of(const std::array<Vec2, 3>& t) {
  return 0.5 * cross(t[1] - t[0], t[2] - t[0]);
}

}  // namespace

FeatureGroups group_features(const Region& region, const std::vector<Vec2>& features,
                             const FeatureGraph& graph) {
  const ImageTriangulation triangulation = triangulate_image(region, features);
  std::vector<std::array<Vec2, 3>> triangles;
  std::vector<std::vector<FeaturePair>> segments;  // by triangle, those that cross it
  for (const auto& t : triangulation.triangles) {
    triangles.push_back({triangulation.points[t[0]], triangulation.points[t[1]], triangulation.points[t[2]]});
    segments.emplace_back();
    for (const FeaturePair& pair : graph.visible)
      if (crosses(features[pair[0]], features[pair[1]], triangles.back())) segments.back().push_back(pair);
  }
  FeatureGroups groups{0, std::vector<std::uint32_t>(features.size(), none)};
  const auto open = [&](const FeaturePair& pair) {
    return groups.group[pair[0]] == none || groups.group[pair[1]] == none;
  };
  while (std::find(groups.group.begin(), groups.group.end(), none) != groups.group.end()) {
    std::size_t best = 0;
    std::pair<std::ptrdiff_t, double> most = {-1, 0};
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const std::pair score(std::count_if(segments[t].begin(), segments[t].end(), open),
                            area_of(triangles[t]));
      if (score <= most) continue;
      most = score;
      best = t;
    }
    for (const FeaturePair& pair : segments[best])
      for (std::uint32_t k : pair)
        if (groups.group[k] == none) groups.group[k] = groups.count;
    if (most.first == 0)  // a feature that sees no other
      *std::find(groups.group.begin(), groups.group.end(), none) = groups.count;
    ++groups.count;
  }
  return groups;
}

InfluenceArea spread_influence(const Region& region, const std::vector<Vec2>& features,
                               const FeatureGraph& graph, const FeatureGroups& groups, double longest_edge) {
  // The features, and the places between those of one group that are held like them.
  std::vector<Vec2> held = features;
  std::vector<std::uint32_t> group = groups.group;
  for (const auto& [i, j] : graph.planar) {
    if (groups.count == 1 || groups.group[i] != groups.group[j]) continue;
    const auto pieces = static_cast<int>(std::ceil(std::abs(features[j] - features[i]) / longest_edge));
    for (int piece = 1; piece < pieces; ++piece) {
      held.push_back(features[i] + double(piece) / pieces * (features[j] - features[i]));
      group.push_back(groups.group[i]);
    }
  }
  InfluenceArea area{triangulate_image(region, held, longest_edge), {}};
  const std::size_t points = area.triangulation.points.size();
  area.influence.assign(points * groups.count, groups.count == 1 ? 1 : 0);
  if (groups.count > 1) {
    std::vector<std::uint32_t> fixed(points, none);
    for (std::size_t k = 0; k < held.size(); ++k) fixed[area.triangulation.features[k]] = group[k];
    std::vector<int> row(points, -1);
    int rows = 0;
    for (std::size_t p = 0; p < points; ++p)
      if (fixed[p] == none) row[p] = rows++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rows, groups.count);
    const auto& at = area.triangulation.points;
    for (const auto& t : area.triangulation.triangles)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t p = t[(k + 1) % 3], q = t[(k + 2) % 3];
        const Vec2 to_p = at[p] - at[t[k]], to_q = at[q] - at[t[k]];
        const double weight = 0.5 * dot(to_p, to_q) / cross(to_p, to_q);
        for (const auto& [a, b] : {std::pair(p, q), std::pair(q, p)}) {
          if (row[a] < 0) continue;
          entries.emplace_back(row[a], row[a], weight);
          if (row[b] >= 0)
            entries.emplace_back(row[a], row[b], -weight);
          else
            right(row[a], fixed[b]) += weight;
        }
      }
    Eigen::SparseMatrix<double> matrix(rows, rows);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::MatrixXd solved = solver.solve(right);
    for (std::size_t p = 0; p < points; ++p)
      for (std::uint32_t l = 0; l < groups.count; ++l)
        area.influence[p * groups.count + l] = row[p] >= 0 ? solved(row[p], l) : fixed[p] == l ? 1 : 0;
  }
  area.triangulation.features.resize(features.size());
  return area;
}

}  // namespace applique
