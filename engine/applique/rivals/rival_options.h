#pragma once

#include <limits>

namespace applique {

/// How much of the surface a planar projection reaches.
struct PlanarLimits {
  double depth = std::numeric_limits<double>::infinity();  ///< Either way from the anchor's tangent plane,
                                                           ///< scene units, > 0.
  double normal_limit = 90;  ///< Between a face's normal and the anchor's, degrees, (0, 180].
};

/// Whom a vertex of a discrete exponential map takes its coordinates from.
enum class Parents {
  one,     ///< The neighbour on its shortest path (Schmidt et al. 2006).
  upwind,  ///< All neighbours that were reached before it, in the mean by inverse squared distance.
};

}  // namespace applique
