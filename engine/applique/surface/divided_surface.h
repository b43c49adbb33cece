#pragma once

#include <cstddef>
#include <span>

#include "applique/surface/surface_mesh.h"

namespace applique {

/// Barycentrics of a triangle's corners in another.
using FaceCorners = std::array<std::array<double, 3>, 3>;
/// Those of a triangle in itself.
inline constexpr FaceCorners whole_face = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// A surface some of whose faces are cut into parts: the same points, more triangles. Faces that are not cut
/// keep their ids, and so does one part of each that is.
struct DividedSurface {
  SurfaceMesh mesh;  ///< Its `source` is that of the whole faces; its corners are not in their order.
  IdVector<FaceId, FaceId> whole;  ///< By face: the face of the undivided surface that it is a part of.
  IdVector<FaceId, FaceCorners> corners;  ///< In the whole face.

  /// A point of the undivided surface, on the part that has it.
  [[nodiscard]] SurfacePoint to_part(const SurfacePoint& point) const;
  /// The other way round.
  [[nodiscard]] SurfacePoint to_whole(const SurfacePoint& point) const;
};

/// How finely a surface is divided where.
struct Division {
  double longest_edge;             ///< Of the parts, scene units, > 0.
  double reach;                    ///< From the places, scene units: what is further away stays as it is.
  std::size_t parts = most_parts;  ///< At most, of all that are cut: then edges stay longer.

  static constexpr std::size_t most_parts = 40'000;
};

/// Whether any face is to be cut.
bool would_divide(const SurfaceMesh& mesh, std::span<const SurfacePoint> places, const Division& division);

/// Cuts the longest edges first, each at its middle and for both its faces, where it is the longest of both:
/// other edges of a neighbour go before (Rivara 1984), so that angles do not become smaller than half the
/// smallest of the surface.
DividedSurface divide_surface(const SurfaceMesh& mesh, std::span<const SurfacePoint> places,
                              const Division& division);

}  // namespace applique
