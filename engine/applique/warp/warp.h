#pragma once

#include <array>
#include <cstdint>
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
struct Warp {
  std::uint32_t steps = 0;  ///< 0: the identity.
  std::uint32_t features = 0;
  std::vector<FeaturePair> pairs;
  std::vector<Vec2> position;  ///< [stage * features + feature]: where the feature is.
  std::vector<Vec2> lambda;    ///< [stage * pairs + pair]: e'/e, the pair's rate of rotation and scale.
  std::vector<Vec2> offset;    ///< [stage * pairs + pair]: F_i' - lambda F_i.

  /// Velocity at p in the given stage; exact at the features.
  [[nodiscard]] Vec2 velocity(Vec2 p, std::uint32_t stage) const;
  /// Where the flow takes p.
  [[nodiscard]] Vec2 operator()(Vec2 p) const;
};

}  // namespace applique
