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

/// A bottle's label, 1024 x 512, opaque but for its notched corners.
Image draw_label();

}  // namespace applique::assets
