#pragma once

#include "applique/decal.h"

namespace applique {

/// Whether the method is one of these.
bool is_rival(Method method);

/// Solves one decal by a method that the paper compares with or builds on (§10.1 of the design). They warp
/// nothing: the image lies as the map wants it.
///
///     planar_map       Method::planar   Lefebvre et al. 2005
///     exponential_map  Method::expmap   Schmidt et al. 2006, and what became of it
///     stroke_map       Method::stroke   Sun et al. 2013; stroke_axis, its line in the image
///     geodesic_front                    what the last two are spread by
///     rival_map                         what all have in common: the anchor, and the similarity to the image
///
/// A lone feature is met, in the wanted size and direction. Of several the one nearest to the middle of the
/// region, the anchor, is met; the others as nearly as the method can, which their residuals tell (warning
/// features_missed). In the result the map to the image is linear in each face, the patch covers each surface
/// face at most once, its vertices are the surface's, and it need not be a disc. Cost follows the patch.
/// `options.energy` and `options.overlap` are not looked at.
///
/// Errors: those of solve_decal.
Result<DecalMap> solve_decal_as_rival(const SurfaceMesh& surface, const DecalInput& input,
                                      const SolveOptions& options);

}  // namespace applique
