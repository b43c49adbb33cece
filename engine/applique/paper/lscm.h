#pragma once

#include <array>
#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

/// A least-squares conformal map of a disc (Lévy et al. 2002, which §5.1 of the paper means; E20 of the
/// design), as the Hermitian form 1/2 z^H (L + K) z, twice Dirichlet's energy less the area (§4.1 of the
/// design): half the unknowns of the usual real system.
struct LscmResult {
  std::vector<Vec2> plane;
  int iterations = 0;
  double residual = 0;  ///< Relative.
};

/// Conjugate gradients from `start`, as the paper wants it, with Jacobi's preconditioner. The two `pins` stay
/// where they are in `start`.
///
/// The result depends on when the iterations stop, for the matrix is as ill-conditioned as a biharmonic one:
/// here at a relative residual of 1e-6, or after 4 sqrt(n) + 100 iterations for n vertices.
LscmResult solve_lscm(const DiscGeometry& disc, const std::vector<Vec2>& start,
                      std::array<std::size_t, 2> pins);

}  // namespace applique
