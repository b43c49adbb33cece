#pragma once

#include "applique/decal.h"

namespace applique {

/// Solves one decal by the paper's own algorithm: "method": "paper". For its figures, and for comparison with
/// solve_decal, which closes its gaps. One step, one file:
///
///     convex_graph    §4.1      the feature-point graph in the image, its faces convex
///     graph_paths     §4.2      the graph on the surface: paths that do not cross within a face
///     face_regions    §4.2      the triangles that the paths of a face bound
///     paper_seed      §4.2      the seed patch, from these and the bridging paths
///     initial_map     §4.3      its initial parameterization
///     lscm            §5.1      the embedding, from the last positions
///     forward_warp    §5.1.1    the warp of the image region to the embedding
///     region_walk     §5.2.1    the set S
///     patch_update    §5.2      removal and insertion, merging
///     paper_solver    Fig. 19   the flow chart
///
/// Where the paper as printed cannot be run it follows the errata of the design's §1, which each file states.
/// The embedding is aligned with the image by a similarity before it is warped, for the paper never fixes its
/// scale and direction (E10). Groups of features and their influence (§5.1.2) are those of region/clusters.h
/// and region/influence.h (E8). The growth ends by the guards of patch_update.h, after ten times
/// `options.max_solves` embeddings, for each adds one strip, and by giving up on rollback (warning
/// rollback_in_vain) after three in a row that find no parameterization in one component: then removal keeps
/// the patch together by itself, as in solve_decal.
///
/// Features are vertices of the surface: they are snapped, and their residual says how far off that leaves
/// them. In the result the map to the image is linear in each face and there is no warp.
///
/// Errors: those of solve_decal. Where the paper asks the artist for another feature, not_solved, which says
/// why and where in the image.
Result<DecalMap> solve_decal_as_paper(const SurfaceMesh& surface, const DecalInput& input,
                                      const SolveOptions& options = {});

}  // namespace applique
