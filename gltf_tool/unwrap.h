#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "uv_conflict.h"
#include "uv_layout.h"

namespace applique {

/// The corners of a triangle of a part in a texture, in texels; none where it is not in it.
using TexelsOf =
    std::function<std::optional<std::array<Texel, 3>>(std::uint32_t part, std::uint32_t triangle)>;

/// The pixels of a decal along the edges over which it goes on from one triangle to another whose texels are
/// out of step with its own.
double seam_pixels(const SolvedJob& job, std::size_t decal, const TexelsOf& texels_of);

/// Whether a decal's triangles of a group can be laid out afresh, by themselves, with every texture of the
/// material resampled, so that the decal crosses at most so many pixels of seams, and look as they do now, to
/// 2/255 where the textures are magnified. A texture that cannot be read does not count: it keeps its
/// coordinates.
bool unwraps_unseen(const SolvedJob& job, const TextureGroup& group, std::vector<SeparatedTriangle> triangles,
                    double most_seams);

}  // namespace applique
