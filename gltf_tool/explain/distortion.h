#pragma once

#include "applique/image/draw.h"
#include "applique/image/image.h"

#include "explain/layout.h"
#include "solve_job.h"

/// Pictures of how a map distorts the image, face by face.
namespace applique {

/// What is painted. Both are 1 for an isometry up to scale, and their means are what the report tells.
enum class Distortion {
  area,   ///< Surface area over image area, total areas made equal: above 1 the image is enlarged.
  angle,  ///< Ratio of the singular values: above 1 circles become ellipses.
};

/// A distortion painted over the whole image.
struct DistortionPicture {
  Distortion kind;
  double limit;    ///< The value at the end of the colours, a round number: few faces are beyond it.
  Image painting;  ///< In the image's shape; grey where the map has no face, transparent outside the region.
};

/// Paints a solved decal's distortion; faces that are turned over are palette::flipped.
DistortionPicture paint_distortion(const SolvedDecal& decal, Distortion kind);

/// The painting where the image is in the panel, and the features.
void draw_distortion(draw::Canvas& canvas, const SolvedDecal& decal, const DistortionPicture& picture,
                     const Box& box);

/// A bar of its colours with numbers, from the largest value at the top to the smallest.
void draw_legend(draw::Canvas& canvas, const DistortionPicture& picture, const Box& box);

}  // namespace applique
