#pragma once

#include <array>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "applique/patch/immersed_disc.h"
#include "applique/region/region.h"

namespace applique {

/// Where a patch vertex is: in the embedding, and in the image.
struct PatchPoint {
  Vec2 plane;
  Vec2 image;
};

/// Of all a disc's vertices, dead ones included.
using PatchPoints = IdVector<PatchVertexId, PatchPoint>;

/// How the growth ended (§2.7 of the design).
enum class Coverage {
  covered,              ///< The whole region lies on the surface.
  clipped_by_boundary,  ///< The surface ends inside the region.
  clipped_by_cover,     ///< The region meets itself on the surface.
  clipped_in_plane,     ///< The surface under the region lies over itself once it is flattened.
  clipped_closed,       ///< The patch has gone all the way round a closed surface.
  clipped_by_limits,    ///< The surface leaves the limits of a planar projection.
  not_converged,        ///< Stopped by the limit of solves.
};

/// Updates a patch between two embeddings (§5.2 of the paper, §2.5 to §2.8 of the design): works with the
/// image points of its vertices alone. Every loop ends: the cover limit bounds what is glued, and a surface
/// face that has been peeled once is never peeled again.
class Growth {
 public:
  Growth(ImmersedDisc& disc, std::vector<PatchFaceId> feature_faces, const Region& region,
         std::uint32_t cover_limit);

  /// Vertices inside the region that are connected with a feature through such vertices: the set S of §5.2.1.
  [[nodiscard]] IdVector<PatchVertexId, char> inside(const PatchPoints& points) const;

  /// Faces that meet the region and are connected with a feature within it. What else lies over the region in
  /// the plane, wound round through what lies outside, is no part of the decal.
  [[nodiscard]] IdVector<PatchFaceId, char> shown(const PatchPoints& points) const;

  /// Removes faces that lie outside the region together with their one-rings, and those that cover again what
  /// their own sheet covers. Returns how many.
  std::size_t peel(const PatchPoints& points, const IdVector<PatchVertexId, char>& inside);
  /// Makes the margin one ring wide all round: removes every face that does not touch one that meets the
  /// region, also where it was peeled before, and completes the fans of those that do. So the patch does not
  /// depend on the way it came about. Returns how many faces were removed or added.
  std::size_t pad(PatchPoints& points);

  struct Limits {
    int rings = 32;
    double share = 0;  ///< Or as many rings as this share of the root of the patch's faces, if they are more.
    double growth = 8;  ///< No further ring once the patch is this many times its size.
  };
  /// Glues rings of faces at the boundary where it lies in the region; where new vertices lie is
  /// predicted by continuing the neighbour's similarity and appended to `points`. Bridges small holes;
  /// `scale`, plane units per scene unit, says what is small. Returns how many faces were added.
  std::size_t grow(PatchPoints& points, IdVector<PatchVertexId, char>& inside, double scale,
                   const Limits& limits);

  /// Covers what the patch has grown round without growing over: an uncovered part of the surface with a
  /// small rim, such as the bottom of a pit whose image was predicted outside the region. Without it the two
  /// fronts that met behind the pit would stay apart for ever. Returns how many faces were added.
  std::size_t fill_pockets(PatchPoints& points, IdVector<PatchVertexId, char>& inside, double scale);

  /// How often a surface face may be covered from now on.
  void set_cover_limit(std::uint32_t cover_limit) { cover_limit_ = cover_limit; }
  [[nodiscard]] std::uint32_t cover_limit() const { return cover_limit_; }

  /// No face is glued any more that would make the patch larger than this, scene units squared.
  void set_most_area(double most_area) { most_area_ = most_area; }
  /// Of the patch, scene units squared.
  [[nodiscard]] double area() const;

  /// Drops dead ids; `points` follows.
  void compact(PatchPoints& points);

  /// Why the boundary cannot move on where it lies in the region, or that it nowhere does.
  [[nodiscard]] Coverage coverage(const PatchPoints& points) const;

  [[nodiscard]] const std::vector<PatchFaceId>& feature_faces() const { return feature_faces_; }

 private:
  struct Side {
    PatchFaceId face;
    int edge;
    Vec2 middle;  ///< In the image: the order of gluing, so that it does not depend on how the model is
                  ///< numbered.
  };
  /// The faces that are reached from the features across edges for which crosses(vertex, vertex);
  /// visit(corners) is called for each before its edges are tried.
  template <class Visit, class Crosses>
  IdVector<PatchFaceId, char> flood(const Visit& visit, const Crosses& crosses) const;
  [[nodiscard]] std::vector<Side> front(const PatchPoints& points,
                                        const IdVector<PatchVertexId, char>& inside,
                                        std::span<const PatchFaceId> candidates) const;
  ImmersedDisc::Glue glue(PatchFaceId q, int k, PatchPoints& points, IdVector<PatchVertexId, char>& inside);
  /// Whether a patch face over f other than `self` lies where the triangle of the image does, or nearby.
  [[nodiscard]] bool covered_nearby(FaceId f, const std::array<Vec2, 3>& image, const PatchPoints& points,
                                    PatchFaceId self = {}) const;
  std::size_t peel_doubles(const PatchPoints& points);
  /// Notes which patch faces lie over which surface face; needed when faces may be covered again.
  void note_cover();
  bool bridge_hole(PatchFaceId q, int k, double scale);

  ImmersedDisc& disc_;
  std::vector<PatchFaceId> feature_faces_;
  const Region& region_;
  std::uint32_t cover_limit_;
  double most_area_ = std::numeric_limits<double>::infinity();
  double area_ = 0;       ///< Kept while most_area_ is finite.
  bool is_full_ = false;  ///< A face was not glued for it.
  std::unordered_map<FaceId, std::uint32_t> peeled_;
  std::unordered_map<FaceId, std::vector<PatchFaceId>>
      over_;  ///< Kept while cover_limit_ > 1; may name the dead.
};

}  // namespace applique
