#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/embed/embed.h"
#include "applique/patch/growth.h"
#include "applique/patch/patch.h"
#include "applique/quality/map_quality.h"
#include "applique/region/region.h"
#include "applique/rivals/rival_options.h"
#include "applique/solve_trace.h"
#include "applique/surface/divided_surface.h"
#include "applique/surface/surface_mesh.h"
#include "applique/warp/stress.h"
#include "applique/warp/warp.h"

namespace applique {

/// A pin: this point of the image lands exactly on that point of the surface.
struct Feature {
  Pixel image;
  SurfacePoint surface;
  double depth = 0;  ///< Order where the region overlaps itself: larger is on top.
};

/// Size and direction for a decal with a single feature.
struct LoneFrame {
  double width;  ///< The image's width on the surface, scene units, > 0.
  Vec3 up;       ///< Direction of the image's upper edge, scene space; not along the surface normal.
};

/// What to stick where.
struct DecalInput {
  std::string name;  ///< For messages.
  Region region;
  std::vector<Feature> features;  ///< At least one.
  std::optional<LoneFrame> lone;  ///< Needed with one feature, ignored with more.
};

/// Who solves: the program's own solver, the paper's algorithm (paper/paper_solver.h), or one of the decal
/// methods before it, which meet one feature only (rivals/rival_solver.h).
enum class Method { applique, paper, planar, expmap, stroke };
inline constexpr std::array all_methods = {Method::applique, Method::paper, Method::planar, Method::expmap,
                                           Method::stroke};
/// As jobs and reports call it: "applique".
const char* name_of(Method method);

/// Whether the image may lie over itself on the surface more often than the paths between the features do.
enum class Overlap {
  stop,   ///< Where the image would meet itself it ends, along a seam of contact.
  allow,  ///< It goes on over itself.
};

struct SolveOptions {
  Method method = Method::applique;
  Energy energy = Energy::isometric;  ///< The paper's method is always conformal.
  /// Draws the last embedding to the features where they ask little of the warp; not a conformal one.
  bool guide = true;
  Overlap overlap = Overlap::stop;
  PlanarLimits planar;                ///< Of Method::planar.
  Parents parents = Parents::upwind;  ///< Of Method::expmap.
  int max_solves = 60;                ///< Embeddings before giving up.
  /// Where the surface's triangles are too large for the decal (it would fold, be cut off or much stretched,
  /// or parts of it that lie over one another share a triangle), they are cut, and the patch is over the
  /// parts: DecalMap::divided. Not set, such a decal is not solved, or folds. Method::applique only.
  bool divide = false;
  SolveTrace* trace = nullptr;  ///< Told what happened, when given.
  bool check_patch =
      false;  ///< Asserts the patch's invariants after every change; builds for debugging always do.
};

/// Seconds by stage.
struct SolveTimes {
  double graph = 0, seed = 0, embed = 0, warp = 0, grow = 0, quality = 0, total = 0;
};

/// A solved decal: the patch and its map into the image.
struct DecalMap {
  Patch patch;
  /// The surface as the patch has it, where the one that was given is too coarse (SolveOptions::divide).
  std::shared_ptr<const DividedSurface> divided;
  IdVector<PatchVertexId, Vec2> plane;   ///< The aligned embedding.
  IdVector<PatchVertexId, Vec2> image;   ///< warp(plane).
  Warp warp;                             ///< plane -> image, exact everywhere.
  IdVector<PatchFaceId, char> linear;    ///< The linear map stands for the warp (to 0.02 px).
  IdVector<PatchFaceId, char> textured;  ///< The face meets the region (and is no bridged hole).
  IdVector<PatchFaceId, double> depth;   ///< Of overlapping faces, from the features'; all 0 without overlap.
  /// Rank of each patch face among those over its surface face, 0 = bottom.
  IdVector<PatchFaceId, std::uint32_t> sheet;
  /// Weight of each group of features at each vertex, [vertex * groups + group]; they sum to 1. One group:
  /// all 1.
  std::uint32_t groups = 1;
  std::vector<double> influence;
  std::vector<std::uint32_t> feature_groups;  ///< By feature; empty when there is one group.
  std::uint32_t sheets = 1;                   ///< How often a surface face is covered at most.
  FeatureGraph graph;
  Coverage status = Coverage::not_converged;
  MapQuality quality;
  /// What the features ask of the warp of an embedding that is not drawn to them; empty by methods that bend
  /// the image otherwise.
  WarpStress stress;
  SolveTimes times;
  int solves = 0;
  std::vector<Warning> warnings;

  /// What the patch lies over: `divided`, or the surface that the decal was solved on.
  [[nodiscard]] const SurfaceMesh& patch_surface(const SurfaceMesh& surface) const {
    return divided != nullptr ? divided->mesh : surface;
  }
  /// The influence of each group at a place in a face: what the warp is to be told there.
  [[nodiscard]] std::vector<double> influence_at(const std::array<PatchVertexId, 3>& corners,
                                                 const std::array<double, 3>& barycentric) const;
};

/// Solves one decal, by the method that the options name. "applique": §2 to §6 of the design; its cost
/// follows the patch, not the surface, but where it divides that, which copies it. Errors, each naming the
/// decal and the features: feature_outside_region, features_coincide, size_missing, features_disconnected,
/// features_mirrored, not_solved.
Result<DecalMap> solve_decal(const SurfaceMesh& surface, const DecalInput& input,
                             const SolveOptions& options = {});

}  // namespace applique
