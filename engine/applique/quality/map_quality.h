#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/patch/patch.h"
#include "applique/region/region.h"
#include "applique/surface/surface_mesh.h"
#include "applique/warp/warp.h"

namespace applique {

/// Singular values of the affine map that takes a triangle of the image to one of space.
struct SingularValues {
  double larger, smaller;  ///< Scene units per plane unit.

  /// Of Sander et al. 2001: the root mean square.
  [[nodiscard]] double squared_l2_stretch() const { return 0.5 * (larger * larger + smaller * smaller); }
};
/// The image's triangle has an area; a turned one has the values of its mirror image.
SingularValues singular_values(const std::array<Vec3, 3>& corners, const std::array<Vec2, 3>& image);

/// Quality of a map from the surface to the image, over the textured faces, each weighted by the share of it
/// that lies in the region (§9 of the design). Stretch is that of Sander et al. 2001, normalised so that an
/// isometry up to scale scores 1. Turned-over faces count as flips and are left out of the means.
struct MapQuality {
  double l2_stretch = 1;
  double linf_stretch = 1;
  double raw_l2_stretch = 0;             ///< Not normalised: scene units per plane unit.
  double angle_distortion = 1;           ///< Area mean of sigma1 / sigma2.
  double area_distortion = 1;            ///< Area mean of max(s1 s2, 1 / (s1 s2)), total areas made equal.
  std::uint32_t flipped_plane = 0;       ///< Triangles turned over in the embedding.
  std::uint32_t flipped_image = 0;       ///< Triangles turned over in the image.
  double coverage = 0;                   ///< Share of the region's area that lands on the surface.
  double doubled = 0;                    ///< Share of it that does so more than once; counted again above.
  double left_out = 0;                   ///< Share of it that is not shown, since it would lie over what is.
  double area = 0;                       ///< Surface area under the region, scene units squared.
  std::vector<double> feature_residual;  ///< Pixels, per feature, in the exact map.
};

/// Beyond this share of the region shown more than once, a map is not injective; less is rounding.
constexpr double hardly_doubled = 0.005;

/// All but the residuals. `plane` and `image` per patch vertex; only faces marked in `textured` are looked
/// at. `influence`, [vertex * groups + group], is not looked at when the warp has one group.
MapQuality measure_quality(const SurfaceMesh& surface, const Patch& patch,
                           const IdVector<PatchVertexId, Vec2>& plane,
                           const IdVector<PatchVertexId, Vec2>& image,
                           const IdVector<PatchFaceId, char>& textured, const Warp& warp,
                           const Region& region, std::span<const double> influence = {});

/// The area that a triangle, counter-clockwise, has in common with the region.
double area_in_region(const Region& region, const std::array<Vec2, 3>& triangle);

}  // namespace applique
