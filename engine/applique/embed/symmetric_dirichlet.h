#pragma once

#include <span>
#include <vector>

#include "applique/embed/disc_geometry.h"
#include "applique/embed/placed_point.h"

namespace applique {

struct SymmetricDirichletOptions {
  double isometry = 1;  ///< In [0, 1]: how much areas count beside angles.
  int max_iterations = 100;
  double tolerance = 1e-4;  ///< Stops when two steps in a row lower the energy by less than this share of it.
  std::span<const PlacedPoint> guide{};  ///< Points that are drawn to their targets.
  std::span<const double> weights{};     ///< By face, > 0: how much its area counts; empty: 1.
};

/// Minimises the area integral of
///   isometry * ((s1^2 + s2^2 + s1^-2 + s2^-2) / 2 + s1 s2 + 1 / (s1 s2)) + (1 - isometry) * (s1 / s2 + s2 /
///   s1)
/// over the stretches s1, s2 of each triangle's map. The isometric part is the symmetric Dirichlet energy
/// (Smith and Schaefer 2015) with a term for area, by which it is the sum of two L2 stretches (Sander et al.
/// 2001): P / D^2 + D for the map, whose least value over all scales is that stretch, and P + 1 / D for its
/// inverse, with D = s1 s2 and P = (s1^2 + s2^2) / 2. The conformal part is that of most isometric
/// parameterizations (Hormann and Greiner 2000). `plane` turns no triangle over and is of the disc's own
/// scale; neither does the result, since the energy is infinite at a collapse and no step goes that far. A
/// `plane` that does is returned as it is.
///
/// A guide adds, over its points, the disc's area times the mean of their squared distances from the targets
/// in terms of how far the targets spread (§4.4 of the design, whose weight has no such unit).
///
/// Steps are those of L-BFGS over a Laplacian that weighs the two directions of each triangle's stretch as
/// scalable locally injective mappings do (Rabinovich et al. 2017), renewed as the map changes. It is one
/// matrix of the vertices' number for both coordinates, an eighth of the work of Newton's.
std::vector<Vec2> relax_symmetric_dirichlet(const DiscGeometry& disc, const std::vector<Vec2>& plane,
                                            const SymmetricDirichletOptions& options = {});

}  // namespace applique
