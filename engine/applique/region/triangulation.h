#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/feature_graph.h"
#include "applique/region/region.h"

namespace applique {

/// A constrained Delaunay triangulation of a region: its contour and the given segments are edges, and no
/// other edge could be flipped to make it more Delaunay.
struct RegionTriangulation {
  std::vector<Vec2> points;  ///< Plane units; the first ones are the polygon's vertices, in order.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise.
  /// Across edge k (opposite corner k, from corner k + 1 to k + 2); -1 at the contour.
  std::vector<std::array<std::int32_t, 3>> neighbours;
  std::vector<std::uint32_t> features;               ///< By feature: its point.
  std::vector<std::vector<std::uint32_t>> segments;  ///< By segment: all points on it, in order.
};

struct TriangulationOptions {
  /// Plane units; 0: no points are added. Otherwise no edge is longer, and no triangle's circumscribed circle
  /// is wider, except where edges shorter than an eighth of that hem the triangle in.
  double max_edge = 0;
};

/// `features` are distinct and lie in the closed region, on the contour, too. `segments` join two of them
/// inside the closed region and do not cross; other features may lie on them.
///
/// Where points are wanted, the centre of the largest circle is added until all are small enough (Chew 1989,
/// "Guaranteed-quality triangular meshes"); a centre behind or too near to an edge that has to stay splits
/// that edge instead (Ruppert 1995). What bounds the error of linear elements is the circle's size, not an
/// angle, so that the pixel-sized steps of a traced contour need no points. Ends: new points keep a distance
/// from all others, short edges are not split, and there is a cap on points.
RegionTriangulation triangulate_region(const Region& region, std::span<const Vec2> features,
                                       std::span<const FeaturePair> segments,
                                       const TriangulationOptions& options = {});

}  // namespace applique
