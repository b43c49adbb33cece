#pragma once

#include <array>
#include <functional>
#include <span>

#include "applique/image/draw.h"
#include "applique/patch/patch.h"

#include "explain/layout.h"
#include "solve_job.h"

/// Drawings of a patch laid out flat, in its embedding or in the image.
namespace applique {

/// The colour of a patch's face; transparent where it is not to be filled.
using FaceColour = std::function<draw::Rgba(PatchFaceId)>;

/// The faces in their colours with their edges, `at` telling where the vertices are.
void draw_patch(draw::Canvas& canvas, const Patch& patch, const IdVector<PatchVertexId, Vec2>& at,
                const PlaneView& view, const FaceColour& colour, double line_width);

/// The colour at a place of a face, given by the weights of its corners.
using PlaceColour = std::function<draw::Rgba(PatchFaceId, const std::array<double, 3>& weights)>;

/// The patch painted place by place, nine samples a pixel; later faces cover earlier ones.
void paint_patch(draw::Canvas& canvas, const Patch& patch, const IdVector<PatchVertexId, Vec2>& at,
                 const PlaneView& view, const Box& box, const PlaceColour& colour);

}  // namespace applique
