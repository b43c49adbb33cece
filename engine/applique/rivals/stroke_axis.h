#pragma once

#include <cstddef>
#include <vector>

#include "applique/base/types.h"

namespace applique {

/// The straight line in the image that a stroke carries to the surface, through the anchor.
struct StrokeAxis {
  Vec2 origin;                        ///< The anchor, plane units.
  Vec2 direction;                     ///< Unit.
  std::vector<std::size_t> features;  ///< On the axis, in order along it.
  std::vector<double> places;         ///< Of these along it, plane units from the origin, increasing.

  [[nodiscard]] double along(Vec2 z) const { return dot(direction, z - origin); }
};

/// The axis of features in the image (plane units): of the lines from the anchor to another feature the one
/// with most features near it, to `tolerance`; then the best fit to these through the anchor. Features that
/// lie beside one another rather than one after another make no line: of those the one that is nearer to the
/// anchor counts. With a lone feature the image's x axis.
StrokeAxis find_stroke_axis(const std::vector<Vec2>& features, std::size_t anchor, double tolerance);

}  // namespace applique
