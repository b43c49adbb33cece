#pragma once

#include <vector>

#include "applique/base/error.h"

#include "mesh.h"

namespace applique::assets {

/// One chart of an atlas with its map to the plane (y up, counter-clockwise like the surface).
struct FlatChart {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> source;  ///< The vertex of the whole mesh that each came from.
  std::vector<Triangle> triangles;
  std::vector<Eigen::Vector2d> uvs;  ///< Filled by flatten() in scene units, by pack() in texels.
};

/// Fills `uvs`: Tutte's embedding, then local/global as-rigid-as-possible steps, kept only as far as no
/// triangle flips. Fails when the chart is not a disc.
Result<void> flatten(FlatChart& chart);

}  // namespace applique::assets
