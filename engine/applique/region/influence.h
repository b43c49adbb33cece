#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/feature_graph.h"
#include "applique/region/region.h"
#include "applique/region/region_locator.h"
#include "applique/region/triangulation.h"

namespace applique {

struct InfluenceOptions {
  double max_edge = 1.0 / 40;  ///< Of the triangulation, in diameters of the region.
};

/// How much each group of features is to move each place of the region: harmonic functions, 1 on the group's
/// own features, 0 on those of other groups, free at the contour (§5.1.2 of the paper). So the influence
/// spreads inside the region, not across what is not part of it.
///
/// The paper asks for this on points alone, where the values would depend on the triangulation: a point has
/// no capacity in the plane. Here they hold all along the feature graph's planar segments between two
/// features of one group, which do not cross those of another (§3.6 of the design). Linear finite elements;
/// all weights are positive, so that the values are between 0 and 1 (the maximum principle).
class InfluenceField {
 public:
  /// `group` gives each feature's group; every number from 0 to the largest is used. At least one feature.
  InfluenceField(const Region& region, std::span<const Vec2> features, const FeatureGraph& graph,
                 std::span<const std::uint32_t> group, const InfluenceOptions& options = {});

  [[nodiscard]] std::uint32_t groups() const { return groups_; }
  /// The influences at z, one per group: >= 0, sum 1. For z outside the region those of its nearest point.
  void at(Vec2 z, std::span<double> influence) const;

  [[nodiscard]] const RegionTriangulation& triangulation() const { return mesh_; }
  /// The influences at a point of the triangulation, one per group.
  [[nodiscard]] std::span<const double> at_point(std::uint32_t point) const {
    return {values_.data() + std::size_t{point} * groups_, groups_};
  }
  /// By triangle: the group with the largest influence there, on average: the paper's region segments.
  [[nodiscard]] std::vector<std::uint32_t> segment_labels() const;

 private:
  void solve(const std::vector<std::uint32_t>& held);

  std::uint32_t groups_ = 0;
  RegionTriangulation mesh_;
  RegionLocator locator_;
  std::vector<double> values_;  ///< [point * groups + group].
};

}  // namespace applique
