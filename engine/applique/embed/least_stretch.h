#pragma once

#include <span>
#include <vector>

#include "applique/embed/disc_geometry.h"
#include "applique/embed/placed_point.h"

namespace applique {

struct StretchOptions {
  double isometry = 1;  ///< In [0, 1]: how much areas count beside angles.
  int max_iterations = 100;
  double tolerance = 1e-4;  ///< Stops when two steps in a row lower the energy by less than this share of it.
  std::span<const PlacedPoint> guide{};  ///< Points that are drawn to their targets.
  std::span<const double> weights{};     ///< By face, > 0: how much its area counts; empty: 1.
};

/// Minimises the area integral of
///   isometry * (P / D^2 + D) + (1 - isometry) * 2 P / D,   P = (s1^2 + s2^2) / 2,   D = s1 s2
/// over the stretches s1, s2 of each triangle's map. The first part is the L2 stretch that maps are judged by
/// (Sander et al. 2001), with areas against it: its least value over all scales is that stretch times the
/// square root of the area. The conformal part is that of most isometric parameterizations (Hormann and
/// Greiner 2000). The symmetric Dirichlet energy (Smith and Schaefer 2015) adds the stretch of the map's
/// inverse, P + 1 / D; it takes more steps and ends with more distortion not of lengths alone, but of angles
/// and areas too, on nearly all surfaces of `./dev compare`.
///
/// `plane` turns no triangle over and is of the disc's own scale; neither does the result, since the energy
/// is infinite at a collapse and no step goes that far. A `plane` that does is returned as it is.
///
/// A guide adds, over its points, a hundred times the disc's area times the mean of their squared distances
/// from the targets in terms of how far the targets spread (§4.4 of the design, whose weight has no such
/// unit). Ten to a thousand times end in the same stretch; at once the area the points are left far off.
///
/// Steps are those of L-BFGS over a Laplacian that weighs the two directions of each triangle's stretch as
/// scalable locally injective mappings do (Rabinovich et al. 2017), renewed as the map changes. It is one
/// matrix of the vertices' number for both coordinates, an eighth of the work of Newton's.
std::vector<Vec2> relax_stretch(const DiscGeometry& disc, const std::vector<Vec2>& plane,
                                const StretchOptions& options = {});

}  // namespace applique
