#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/transfer/transfer.h"

namespace applique {

/// A triangle laid out in a plane, in texels. Triangles with two ids in common lie side by side there.
struct ChartTriangle {
  std::array<Texel, 3> corners;
  std::array<std::uint32_t, 3> vertices;  ///< Ids of the places of its corners.
};

/// Parts the triangles into charts: connected, of one orientation, and without a texel that two of a chart's
/// triangles have. Grown greedily over the edges from the first triangle that has no chart yet, so that a
/// layout without folds and overlap keeps one chart for each connected piece. Returns lists of indices.
/// Triangles have an area; each is alone where nothing else will do.
std::vector<std::vector<std::uint32_t>> grow_charts(std::span<const ChartTriangle> triangles);

/// The same of triangles with these corners, each beside those of its list.
std::vector<std::vector<std::uint32_t>> grow_charts(std::span<const std::array<Texel, 3>> corners,
                                                    std::span<const std::vector<std::uint32_t>> beside);

}  // namespace applique
