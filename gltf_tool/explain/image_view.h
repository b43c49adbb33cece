#pragma once

#include <span>
#include <vector>

#include "applique/image/draw.h"
#include "applique/region/feature_graph.h"

#include "explain/layout.h"
#include "solve_job.h"

/// Drawings in the image's plane: the image itself, the contour, features and pairs of them.
namespace applique {

/// Sizes of lines and marks in a panel, pixels.
struct Pen {
  double thin, line, bold;  ///< Widths.
  double mark;              ///< A feature's radius.
};
Pen pen_for(const Box& box);

/// Shows the whole image in the box.
PlaneView view_of_image(const SolvedDecal& decal, const Box& box);

/// The colour around a place of the image: the mean over a square of `footprint` pixels a side.
draw::Rgba sample_image(const Image& image, Pixel at, double footprint);

/// The image faded towards white: `strength` of it is left inside the region, less outside.
void draw_image(draw::Canvas& canvas, const SolvedDecal& decal, const PlaneView& view, double strength);

void draw_contour(draw::Canvas& canvas, std::span<const Vec2> contour, const PlaneView& view, double width);

/// Numbered discs; `groups`, one per feature, colours them, otherwise all have one colour.
void draw_features(draw::Canvas& canvas, std::span<const Vec2> features, const PlaneView& view,
                   const Pen& pen, std::span<const std::uint32_t> groups = {});
void draw_feature(draw::Canvas& canvas, Vec2 at, std::size_t number, double radius, const draw::Rgba& colour);

/// The segments between features.
void draw_pairs(draw::Canvas& canvas, std::span<const Vec2> features, std::span<const FeaturePair> pairs,
                const PlaneView& view, double width, const draw::Rgba& colour);

/// The features' places in the image, plane units.
std::vector<Vec2> targets_of(const SolvedDecal& decal);

}  // namespace applique
