#include "applique/finer_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "applique/decal_input.h"
#include "applique/region/feature_graph.h"
#include "applique/surface/shortest_path.h"

namespace applique {
namespace {

constexpr double wide_reach = 1.5;      // times how far the region goes from its features
constexpr double hardly_shorter = 0.8;  // a way over smaller triangles
constexpr int most_rounds = 4;          // of measuring ways

/// Scene units per plane unit: of all ways between neighbours the one that has least.
double scale_of(const SurfaceMesh& surface, const std::vector<SurfacePoint>& places,
                const std::vector<Vec2>& targets, const std::vector<FeaturePair>& tree) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [i, j] : tree) {
    const auto length = way_length(surface, places[i], places[j]);
    if (length) least = std::min(least, *length / std::abs(targets[i] - targets[j]));
  }
  return least;
}

/// As a strip's would be.
double width_of(const Region& region) {
  double perimeter = 0;
  const std::vector<Vec2>& polygon = region.polygon();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    perimeter += std::abs(polygon[(i + 1) % polygon.size()] - polygon[i]);
  return 2 * region.area() / perimeter;
}

/// How far the region goes from the feature that is nearest, at most.
double reach_of(const Region& region, const std::vector<Vec2>& targets) {
  double reach = 0;
  for (const Vec2 z : region.polygon()) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec2 target : targets) nearest = std::min(nearest, std::abs(z - target));
    reach = std::max(reach, nearest);
  }
  return reach;
}

}  // namespace

std::shared_ptr<const DividedSurface> finer_surface(const SurfaceMesh& surface, const DecalInput& input,
                                                    double share) {
  const std::vector<Vec2> targets = targets_of(input);
  const bool lone = targets.size() == 1;
  const std::vector<FeaturePair> tree = build_feature_graph(input.region, targets).tree;
  std::vector<SurfacePoint> places;
  for (const Feature& feature : input.features) places.push_back(feature.surface);
  const double width = width_of(input.region), reach = wide_reach * reach_of(input.region, targets);
  const auto divided_at = [&](double scale) {
    return std::make_shared<const DividedSurface>(
        divide_surface(surface, places, {share * scale * width, scale * reach}));
  };
  double scale = lone ? 1 / lone_scale(input) : scale_of(surface, places, targets, tree);
  auto divided = divided_at(scale);
  // Ways along the edges of large triangles are longer than they are over the surface.
  for (int round = 0; round < most_rounds && !lone; ++round) {
    std::vector<SurfacePoint> parts;
    for (const SurfacePoint& place : places) parts.push_back(divided->to_part(place));
    const double measured = scale_of(divided->mesh, parts, targets, tree);
    if (measured > hardly_shorter * scale) break;
    scale = measured;
    divided = divided_at(scale);
  }
  return divided;
}

}  // namespace applique
