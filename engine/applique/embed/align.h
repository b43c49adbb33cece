#pragma once

#include <span>

#include "applique/base/types.h"

namespace applique {

/// z -> scale z + shift: rotation, uniform scale and translation.
struct Similarity {
  Vec2 scale = 1;
  Vec2 shift = 0;
  Vec2 operator()(Vec2 z) const { return scale * z + shift; }
};

/// The similarity that brings `from` nearest to `to` in the sum of squares (complex Procrustes; §3.2 of the
/// design). Exact for two points. At least two points, not all `from` equal.
Similarity fit_similarity(std::span<const Vec2> from, std::span<const Vec2> to);

/// Whether a reflection brings `from` much nearer to `to` than a similarity does: the correspondence is
/// mirrored, and no map that keeps the orientation can follow it. Needs three points that are not collinear;
/// false for fewer.
bool is_mirrored(std::span<const Vec2> from, std::span<const Vec2> to);

}  // namespace applique
