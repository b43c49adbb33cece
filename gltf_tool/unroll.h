#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "uv_layout.h"

namespace applique {

/// Triangles in a plane, some of them side by side.
struct Unrolled {
  std::vector<std::array<Texel, 3>> corners;       ///< By triangle; pixels.
  std::vector<std::vector<std::uint32_t>> beside;  ///< By triangle: those that it hangs together with.
};

/// Rolls a surface's triangles out flat, each as it is on the surface, hinged to one another along a tree of
/// the edges that the decals cross, those first that they cross over the most pixels; only such triangles
/// that are listed for one decal. Where the surface is curved, other edges gape; the triangles of a piece may
/// lie over one another. About as large as the decal is on each piece, in pixels, and turned so that its box
/// is small. A triangle without an area becomes one of half a pixel, alone.
Unrolled unroll(const SolvedJob& job, std::span<const SeparatedTriangle> triangles);

/// A triangle of the surface flat in the plane, seen from its front with y downwards, as large as there, its
/// first corner at the origin.
std::array<Texel, 3> flatten(const SolvedJob& job, const SeparatedTriangle& triangle);

}  // namespace applique
