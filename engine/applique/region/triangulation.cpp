#include "applique/region/triangulation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <optional>
#include <queue>

#include "applique/region/delaunay.h"

namespace applique {
namespace {

// Edges that have to stay are split down to this share of the largest circle's radius.
constexpr double shortest_split = 0.25;
// Points allowed per largest circle that fits into the area or along the edges; a third of it is usual.
constexpr double points_per_circle = 8;

/// The numbers of the vertices. Coarse to fine, so that each lies near the one before and the triangles stay
/// round.
std::vector<std::uint32_t> insert_contour(DelaunayMesh& mesh, const std::vector<Vec2>& polygon) {
  std::vector<std::uint32_t> number(polygon.size());
  const std::size_t coarsest = std::bit_ceil(polygon.size());
  for (std::size_t step = coarsest; step > 0; step /= 2) {
    for (std::size_t i = step == coarsest ? 0 : step; i < polygon.size(); i += 2 * step) {
      number[i] = mesh.insert(polygon[i]);
    }
  }
  return number;
}

/// Adds points until the circumscribed circles are small enough.
class Refinement {
 public:
  Refinement(DelaunayMesh& mesh, double max_edge, double area) : mesh_(mesh), max_radius_(0.5 * max_edge) {
    double fixed_length = 0;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles()); ++t) {
      if (!mesh.inside(t)) continue;
      judge(t);
      for (std::int32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
        if (mesh.fixed(edge)) fixed_length += length(edge);
      }
    }
    most_points_ = mesh.points().size() +
                   static_cast<std::size_t>(points_per_circle * (area / (max_radius_ * max_radius_) +
                                                                 fixed_length / max_radius_ + 1));
  }

  void run() {
    while (!large_.empty() && mesh_.points().size() < most_points_) {
      const Large next = large_.top();
      large_.pop();
      if (next.corners == corners(next.triangle)) improve(next);
    }
  }

 private:
  struct Large {
    double radius;  ///< Of the circumscribed circle, centred here:
    Vec2 centre;
    std::int32_t triangle;
    std::array<std::uint32_t, 3> corners;  ///< When it was found: another triangle may have its number since.
    bool operator<(const Large& other) const { return radius < other.radius; }
  };

  [[nodiscard]] std::array<std::uint32_t, 3> corners(std::int32_t t) const {
    return {mesh_.corner(3 * t), mesh_.corner(3 * t + 1), mesh_.corner(3 * t + 2)};
  }
  [[nodiscard]] double length(std::int32_t edge) const {
    return std::abs(mesh_.points()[mesh_.to(edge)] - mesh_.points()[mesh_.from(edge)]);
  }

  void judge(std::int32_t triangle) {
    const auto corner = corners(triangle);
    const Vec2 a = mesh_.points()[corner[0]];
    const Vec2 b = mesh_.points()[corner[1]] - a, c = mesh_.points()[corner[2]] - a;
    const Vec2 centre = Vec2(0, 1) * (b * std::norm(c) - c * std::norm(b)) / (2 * cross(b, c));
    const double radius = std::abs(centre);
    if (radius > max_radius_ && std::isfinite(radius)) large_.push({radius, a + centre, triangle, corner});
  }

  void improve(const Large& large) {
    const auto [triangle, wall] = mesh_.walk(large.triangle, large.centre);
    const std::int32_t obstacle = triangle < 0 ? wall : mesh_.encroached_by(large.centre, triangle);
    std::optional<std::uint32_t> point;
    if (obstacle >= 0) {
      if (length(obstacle) > shortest_split * max_radius_) point = mesh_.split_fixed(obstacle);
      if (point) large_.push(large);  // It may still be there.
    } else if (triangle >= 0) {
      point = mesh_.insert_into(triangle, large.centre);
    }
    if (!point) return;
    mesh_.visit_star(*point, [&](std::int32_t edge) {
      if (mesh_.inside(edge / 3)) judge(edge / 3);
    });
  }

  DelaunayMesh& mesh_;
  double max_radius_;
  std::size_t most_points_;
  std::priority_queue<Large> large_;
};

/// By point of the mesh: its number when the box is left out and the contour comes first.
std::vector<std::uint32_t> renumber(const DelaunayMesh& mesh, const std::vector<std::uint32_t>& contour) {
  constexpr std::uint32_t none = ~0U;
  std::vector<std::uint32_t> place(mesh.points().size(), none);
  std::uint32_t count = 0;
  for (const std::uint32_t point : contour) place[point] = count++;
  for (std::size_t i = DelaunayMesh::box_corners; i < place.size(); ++i) {
    if (place[i] == none) place[i] = count++;
  }
  return place;
}

}  // namespace

RegionTriangulation triangulate_region(const Region& region, std::span<const Vec2> features,
                                       std::span<const FeaturePair> segments,
                                       const TriangulationOptions& options) {
  const std::vector<Vec2>& polygon = region.polygon();
  DelaunayMesh mesh(polygon[0], region.diameter());
  const std::vector<std::uint32_t> contour = insert_contour(mesh, polygon);
  std::vector<std::uint32_t> feature_points;
  for (const Vec2 z : features) feature_points.push_back(mesh.insert(z));
  for (std::size_t i = 0; i < contour.size(); ++i) mesh.fix(contour[i], contour[(i + 1) % contour.size()]);
  mesh.mark_inside();
  std::vector<std::vector<std::uint32_t>> chains;
  for (const auto& [a, b] : segments) chains.push_back(mesh.fix(feature_points[a], feature_points[b]));
  if (options.max_edge > 0) Refinement(mesh, options.max_edge, region.area()).run();

  RegionTriangulation result;
  const std::vector<std::uint32_t> place = renumber(mesh, contour);
  result.points.resize(place.size() - DelaunayMesh::box_corners);
  for (std::size_t i = DelaunayMesh::box_corners; i < place.size(); ++i) {
    result.points[place[i]] = mesh.points()[i];
  }
  std::vector<std::int32_t> number(mesh.triangles(), -1);
  std::int32_t count = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(number.size()); ++t) {
    if (mesh.inside(t)) number[t] = count++;
  }
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(number.size()); ++t) {
    if (number[t] < 0) continue;
    auto& corners = result.triangles.emplace_back();
    auto& neighbours = result.neighbours.emplace_back();
    for (int k = 0; k < 3; ++k) {
      corners[k] = place[mesh.corner(3 * t + k)];
      neighbours[k] = number[mesh.twin(3 * t + k) / 3];
    }
  }
  for (const std::uint32_t point : feature_points) result.features.push_back(place[point]);
  for (const auto& chain : chains) {
    auto& segment = result.segments.emplace_back(1, place[chain[0]]);
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const std::vector<std::uint32_t> pieces = mesh.pieces(chain[i - 1], chain[i]);
      std::transform(pieces.begin() + 1, pieces.end(), std::back_inserter(segment),
                     [&](std::uint32_t point) { return place[point]; });
    }
  }
  return result;
}

}  // namespace applique
