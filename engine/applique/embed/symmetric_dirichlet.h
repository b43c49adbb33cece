#pragma once

#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

struct SymmetricDirichletOptions {
  int max_iterations = 100;
  double tolerance = 1e-4;  ///< Stops when two steps in a row lower the energy by less than this share of it.
};

/// Minimises the symmetric Dirichlet energy, the area integral of (s1^2 + s2^2 + s1^-2 + s2^-2) / 2 over the
/// singular values of each triangle's map (Smith and Schaefer 2015). `plane` turns no triangle over and is of
/// the disc's own scale; neither does the result, since the energy is infinite at a collapse and no step goes
/// that far. A `plane` that does is returned as it is.
///
/// Steps are those of L-BFGS over a Laplacian that weighs the two directions of each triangle's stretch as
/// scalable locally injective mappings do (Rabinovich et al. 2017), renewed as the map changes. It is one
/// matrix of the vertices' number for both coordinates, an eighth of the work of Newton's.
std::vector<Vec2> relax_symmetric_dirichlet(const DiscGeometry& disc, const std::vector<Vec2>& plane,
                                            const SymmetricDirichletOptions& options = {});

}  // namespace applique
