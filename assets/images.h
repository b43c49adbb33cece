#pragma once

#include "applique/base/types.h"
#include "applique/image/image.h"

/// The demo's images, drawn with applique/image/draw.h: RGBA, straight alpha.
namespace applique::assets {

/// A harlequin mask for a face, 1024 x 1024, transparent around its outline and in the eyes.
Image draw_mask();

/// Where the mask expects the face's features, in its pixels. "left" is the wearer's left: the image's right.
namespace mask_place {
constexpr Pixel forehead{512, 205};
constexpr Pixel left_eye_inner{604, 440};
constexpr Pixel left_eye_outer{772, 418};
constexpr Pixel nose_root{512, 420};
constexpr Pixel nose_tip{512, 634};
constexpr Pixel left_mouth_corner{648, 808};
constexpr Pixel mouth_middle{512, 806};
constexpr Pixel chin{512, 962};
}  // namespace mask_place

/// A crest, shield with star and laurel, 768 x 768, transparent around.
Image draw_emblem();

/// A painting's relief as a normal map, y up: raised from its outline on, bright paint more than dark.
Image draw_relief(const Image& painting);

/// A bottle's label, 1024 x 512, opaque but for its notched corners.
Image draw_label();

/// For the gallery: bands along a curve, and a star; transparent around.
Image draw_snake();      ///< Three half waves, 1024 x 512.
Image draw_horseshoe();  ///< Open at the top, 768 x 700.
Image draw_belt();       ///< Straight, 2000 x 200.
Image draw_star();       ///< Five points, 640 x 640.

/// The middle of the snake at t, 0 at its left end and 1 at its right one.
Pixel snake_point(double t);

}  // namespace applique::assets
