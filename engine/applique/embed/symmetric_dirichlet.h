#pragma once

#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

struct SymmetricDirichletOptions {
  int max_iterations = 20;
  double tolerance = 1e-4;  ///< Stops when a step lowers the energy by less than this share of it.
};

/// Minimises the symmetric Dirichlet energy, the area integral of (s1^2 + s2^2 + s1^-2 + s2^-2) / 2 over the
/// singular values of each triangle's map (Smith and Schaefer 2015), by Newton's method with each triangle's
/// Hessian projected to be positive (analytic eigensystem of Smith et al. 2019). `plane` turns no triangle
/// over and is of the disc's own scale; neither does the result, since the energy is infinite at a collapse
/// and no step goes that far.
std::vector<Vec2> relax_symmetric_dirichlet(const DiscGeometry& disc, std::vector<Vec2> plane,
                                            const SymmetricDirichletOptions& options = {});

}  // namespace applique
