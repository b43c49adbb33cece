#pragma once

#include <span>
#include <vector>

#include "applique/warp/warp.h"

namespace applique {

/// What a feature asks of the warp.
struct FeatureStress {
  double shift;  ///< How far it moves, plane units.
  double scale;  ///< Of its neighbourhood: length in the image over length in the plane.
  double turn;   ///< Of its neighbourhood, radians, counter-clockwise; beyond pi where it turns that far.
};

/// What a pair of features asks of the warp.
struct PairStress {
  FeaturePair pair;
  double scale;  ///< Length in the image over length in the plane.
  double turn;   ///< Radians, in (-pi, pi].
};

/// How far a warp must turn, scale and shift the aligned embedding to meet the features (§3.2 of the design).
/// Nothing to do is shift 0, scale 1, turn 0.
struct WarpStress {
  std::vector<FeatureStress> features;  ///< By feature.
  std::vector<PairStress> pairs;
};

/// The stress of a warp that carries `from` to `to`; `pairs` are those to be told of. At a feature the warp
/// is conformal: the velocity's derivative there is the mean of its pairs' lambda, weighted by 1 / d^2, and
/// its integral over time is the logarithm of the warp's derivative.
WarpStress measure_stress(std::span<const Vec2> from, std::span<const Vec2> to,
                          std::span<const FeaturePair> pairs, const Warp& warp);

/// Whether something is scaled by more than 4 or less than 1/4, or turned by more than 120 degrees: the warp
/// can do it, but the image then rarely looks as it was meant.
bool is_extreme(double scale, double turn);

}  // namespace applique
