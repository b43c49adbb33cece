#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// The warp of the plane that carries the embedded features exactly to their image points: the pathline flow
/// of a time-dependent vector field (§5.1.1 of the paper), written in complex form (§3.1 of the design) and
/// run in the direction that is needed: plane -> image. Immutable and cheap to evaluate; the GPU gets the
/// same tables.
///
/// Time [0, 1] is cut into `steps` equal steps of the classical Runge-Kutta scheme of order 4. Each step has
/// three stage times (its start, middle and end): stage 3 * step + {0, 1, 2}.
///
/// Where the region overlaps itself in the plane, features belong to groups, and a place has an *influence*
/// per group (>= 0, sum 1): how much that group's features are to move it. A pair counts by the product of
/// its features' influence after a ramp that cuts off what is small, so that features of a sheet that merely
/// lies over this one do nothing (§3.7 of the design; it replaces the sum rule of §5.1.2 of the paper, which
/// folds).
struct Warp {
  std::uint32_t steps = 0;  ///< 0: the identity.
  std::uint32_t features = 0;
  std::uint32_t groups = 1;
  std::vector<std::uint32_t> group;  ///< By feature; empty when there is one group.
  std::vector<FeaturePair> pairs;
  std::vector<Vec2> position;  ///< [stage * features + feature]: where the feature is.
  std::vector<Vec2> lambda;    ///< [stage * pairs + pair]: e'/e, the pair's rate of rotation and scale.
  std::vector<Vec2> offset;    ///< [stage * pairs + pair]: F_i' - lambda F_i.

  /// Velocity at p in the given stage; exact at the features. `influence`, one per group, is not looked at
  /// when there is one group.
  [[nodiscard]] Vec2 velocity(Vec2 p, std::uint32_t stage, std::span<const double> influence = {}) const;
  /// Where the flow takes p.
  [[nodiscard]] Vec2 operator()(Vec2 p, std::span<const double> influence = {}) const;
  /// Where the flow comes from that ends at p, to the integration's tolerance: image -> plane.
  [[nodiscard]] Vec2 backward(Vec2 p, std::span<const double> influence = {}) const;
};

/// The warp at many places, on all cores; `influence`, [place * groups + group], is not looked at when there
/// is one group.
std::vector<Vec2> warp_all(const Warp& warp, const std::vector<Vec2>& places,
                           const std::vector<double>& influence = {});

/// How an influence counts in a warp of `groups` groups: 0 up to a threshold, 1 from 1 less the threshold,
/// smooth between. The largest of them always counts.
double influence_ramp(double influence, std::uint32_t groups);

}  // namespace applique
