#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

/// The same among the similarities that are exact at point `fixed`; not all `from` equal it.
Similarity fit_similarity_about(std::size_t fixed, std::span<const Vec2> from, std::span<const Vec2> to);

/// fit_similarity with the edges' mean length in place of the best scale: for places that a similarity does
/// not bring near to one another, such as those of a ribbon that is a loop in one plane and straight in the
/// other. The edges join all points.
Similarity fit_by_edges(std::span<const Vec2> from, std::span<const Vec2> to,
                        std::span<const std::array<std::uint32_t, 2>> edges);

/// Whether a reflection brings `from` much nearer to `to` than a similarity does, and turns most of the area
/// of `triangles`, if there are any: the correspondence is mirrored, and no map that keeps the orientation
/// can follow it. Needs three points that are not collinear; false for fewer.
bool is_mirrored(std::span<const Vec2> from, std::span<const Vec2> to,
                 std::span<const std::array<std::uint32_t, 3>> triangles = {});

/// Whether `features` turn every one of several triangles over, which are counter-clockwise in the image.
bool all_turned(std::span<const Vec2> features, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace applique
