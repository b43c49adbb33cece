#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "applique/base/error.h"
#include "applique/transfer/transfer.h"

#include "material.h"
#include "solve_job.h"

namespace applique {

/// A triangle of the model that is to have texture space of its own, and what a decal has over it.
struct SeparatedTriangle {
  std::uint32_t part = 0;          ///< Index in Model::parts.
  std::uint32_t triangle = 0;      ///< Index in its triangles.
  std::size_t decal = 0;           ///< Index in SolvedJob::decals.
  std::vector<PatchFaceId> faces;  ///< The decal's on it: one, or some parts of a divided surface.
  bool unwrap = false;             ///< It is laid out as the decal lies on it, whatever it has now.
};

/// What a layout starts from.
struct LayoutRequest {
  std::vector<SeparatedTriangle> triangles;
  std::array<int, 2> texture = {0, 0};  ///< Texels of the texture that they show now; 0: none.
  int grid = 1;                         ///< Charts move by multiples of so many texels.
  int created_size = 0;                 ///< Not 0: the atlas is a square of this side, which the charts fill.
};

/// A connected piece of an atlas.
struct AtlasChart {
  std::vector<std::uint32_t> triangles;  ///< Indices in LayoutRequest::triangles.
  bool kept = false;  ///< Laid out as in the old texture: old texel * scale = unit + shift.
  std::array<double, 2> shift = {0, 0};
  std::array<int, 4> box = {0, 0, 0, 0};  ///< With its gutter: x, y, width, height; units.
};

/// Where separated triangles are in their atlas, in units. A unit is a texel of the old texture, as long as
/// `scale` is 1.
struct UvLayout {
  std::vector<std::array<Texel, 3>> corners;  ///< By triangle of the request.
  std::vector<AtlasChart> charts;
  std::array<int, 2> size = {0, 0};  ///< Of the new base colour, in its texels.
  int fineness = 1;                  ///< Of those texels along a unit. Odd: the old texels' centres stay
                                     ///< centres, so that bilinear filtering shows what it showed.
  double scale = 1;
  int gutter = 0;  ///< Units around each chart.

  /// Texture coordinates of a place.
  [[nodiscard]] std::array<double, 2> uv(const Texel& unit) const {
    return {unit[0] * fineness / size[0], unit[1] * fineness / size[1]};
  }
};

/// Charts and packs them. Triangles keep the layout that they have in the old texture, moved by whole texels,
/// so that what is resampled is the same to the bit: one chart for each connected, unfolded, not overlapping
/// piece. Those that have no texture coordinates, or such that the decal would be a smear (in some direction
/// fewer than 1/32 texel for a pixel), are laid out as the decal's embedding is in the plane, at one texel a
/// pixel or more; so are those that are to be unwrapped. What an embedding does not lay out, triangles of
/// which a divided decal has parts among them, is rolled out (unroll.h). Where the old texture has less than
/// 1/2 texel along a tenth of the decals' pixels, the base colour becomes finer, as far as the old texture's
/// size or the job's texture size allow.
///
/// Errors: not_solved when there are more charts than an atlas of 8192 x 8192 texels has room for.
Result<UvLayout> lay_out_uvs(const SolvedJob& job, const LayoutRequest& request);

/// Whether a triangle's texture coordinates are fit for a decal, in a texture of this size.
bool has_texture_space(const SolvedJob& job, const SeparatedTriangle& triangle,
                       const std::array<int, 2>& texture);

/// Whether a triangle that is laid out so, in texels, has enough of them for the decal.
bool is_fine_enough(const SolvedJob& job, const SeparatedTriangle& triangle,
                    const std::array<Texel, 3>& texels);

/// The pixels of the decal's image on a triangle; on one that it has parts of, as many as if it had all.
double pixels_on(const SolvedJob& job, const SeparatedTriangle& triangle);

/// Its texture coordinates, in texels of a texture of this size.
std::array<Texel, 3> texels_of(const SolvedJob& job, const SeparatedTriangle& triangle,
                               const std::array<int, 2>& texture);

/// The same through the mapping of any texture of the triangles' materials, in such a texture; none where a
/// part has no such coordinates.
std::vector<std::optional<std::array<Texel, 3>>> texels_through(const SolvedJob& job,
                                                                std::span<const SeparatedTriangle> triangles,
                                                                const UvMapping& mapping,
                                                                const std::array<int, 2>& texture);

}  // namespace applique
