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

struct Scales {
  double least = std::numeric_limits<double>::infinity(), most = 0;
};

/// Scene units per plane unit along the ways between neighbours.
Scales scales_along(const SurfaceMesh& surface, const std::vector<SurfacePoint>& places,
                    const std::vector<Vec2>& targets, const std::vector<FeaturePair>& tree) {
  Scales scales;
  for (const auto& [i, j] : tree) {
    const auto length = way_length(surface, places[i], places[j]);
    if (!length) continue;
    const double scale = *length / std::abs(targets[i] - targets[j]);
    scales = {std::min(scales.least, scale), std::max(scales.most, scale)};
  }
  return scales;
}

/// As a strip's would be.
double width_of(const Region& region) {
  double perimeter = 0;
  const std::vector<Vec2>& polygon = region.polygon();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    perimeter += std::abs(polygon[(i + 1) % polygon.size()] - polygon[i]);
  return 2 * region.area() / perimeter;
}

/// How far the region goes from the feature that is nearest, at most: along its contour, or amid features.
double reach_of(const Region& region, const std::vector<Vec2>& targets,
                const std::vector<FeaturePair>& tree) {
  constexpr int parts = 16;  // of an edge
  double reach = 0;
  const std::vector<Vec2>& polygon = region.polygon();
  for (std::size_t k = 0; k < polygon.size(); ++k)
    for (int part = 0; part < parts; ++part) {
      const Vec2 z =
          polygon[k] + static_cast<double>(part) / parts * (polygon[(k + 1) % polygon.size()] - polygon[k]);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec2 target : targets) nearest = std::min(nearest, std::abs(z - target));
      reach = std::max(reach, nearest);
    }
  for (const auto& [i, j] : tree) reach = std::max(reach, 0.5 * std::abs(targets[i] - targets[j]));
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
  const double width = width_of(input.region), reach = wide_reach * reach_of(input.region, targets, tree);
  const auto divided_at = [&](const Scales& scales) -> std::shared_ptr<const DividedSurface> {
    const Division division{share * scales.least * width, scales.most * reach};
    if (!would_divide(surface, places, division)) return nullptr;
    return std::make_shared<const DividedSurface>(divide_surface(surface, places, division));
  };
  Scales scales = lone ? Scales{1 / lone_scale(input), 1 / lone_scale(input)}
                       : scales_along(surface, places, targets, tree);
  auto divided = divided_at(scales);
  // Ways along the edges of large triangles are longer than they are over the surface.
  for (int round = 0; round < most_rounds && !lone && divided != nullptr; ++round) {
    std::vector<SurfacePoint> parts;
    for (const SurfacePoint& place : places) parts.push_back(divided->to_part(place));
    const Scales measured = scales_along(divided->mesh, parts, targets, tree);
    if (measured.least > hardly_shorter * scales.least) break;
    scales = measured;
    divided = divided_at(scales);
  }
  return divided;
}

}  // namespace applique
