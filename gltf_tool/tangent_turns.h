#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/types.h"
#include "applique/transfer/transfer.h"

#include "uv_resample.h"

namespace applique {

/// Triangles of one primitive in two layouts, in the primitive's own space.
struct TangentFrames {
  std::vector<Vec3> positions;                  ///< By vertex.
  std::vector<Vec3> normals;                    ///< By vertex; empty: the faces are flat.
  std::vector<std::array<double, 4>> tangents;  ///< As in the file, by vertex; empty: by the old layout.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<Texel, 3>> old_corners;  ///< v down.
  std::vector<std::array<Texel, 3>> new_corners;  ///< v down.
};

/// What becomes of the tangent frames, by triangle and corner.
struct TangentTurns {
  std::vector<std::array<FrameTurn, 3>> turns;
  std::vector<std::array<std::array<float, 4>, 3>> tangents;  ///< Of the new layout, as glTF's TANGENT.
};

/// A vertex's tangent runs along u, across its normal, meaned by area over the triangles that have its
/// coordinates in common; the bitangent runs against v. Where coordinates are collapsed, nothing turns.
TangentTurns turn_tangents(const TangentFrames& frames);

/// Whether directions in a texture mean the same through both layouts: their u axes run alike in every
/// triangle, and neither is mirrored against the other.
bool same_frames(const std::vector<std::array<Texel, 3>>& old_corners,
                 const std::vector<std::array<Texel, 3>>& new_corners);

}  // namespace applique
