#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "applique/image/draw.h"
#include "applique/patch/patch.h"

#include "explain/layout.h"
#include "solve_job.h"

/// Drawings of triangles in the plane or in the image: patches laid out flat, the region.
namespace applique {

/// The colour of a patch's face; transparent where it is not to be filled.
using FaceColour = std::function<draw::Rgba(PatchFaceId)>;

/// The faces in their colours with their edges, `at` telling where the vertices are.
void draw_patch(draw::Canvas& canvas, const Patch& patch, const IdVector<PatchVertexId, Vec2>& at,
                const PlaneView& view, const FaceColour& colour, double line_width);

using TriangleCorners = std::array<std::uint32_t, 3>;

/// The corners of the patch's faces, by index of its vertices.
std::vector<TriangleCorners> triangles_of(const Patch& patch);

/// The colour at a place of a triangle, given by its index and the weights of its corners.
using PlaceColour = std::function<draw::Rgba(std::size_t, const std::array<double, 3>& weights)>;

/// Triangles painted place by place, nine samples a pixel; later ones cover earlier ones.
void paint_triangles(draw::Canvas& canvas, std::span<const Vec2> points,
                     std::span<const TriangleCorners> triangles, const PlaneView& view, const Box& box,
                     const PlaceColour& colour);

}  // namespace applique
