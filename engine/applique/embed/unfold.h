#pragma once

#include <cstddef>
#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

/// Smooths out local folds of an embedding: around each cluster of turned-over triangles the vertices within
/// a round neighbourhood are placed anew inside its rim by mean value coordinates, in a larger neighbourhood
/// where that was not enough. A pit too deep for its mouth (a nostril, an ear) is compressed into it;
/// everything else stays as it is. Returns how many triangles are still turned over.
std::size_t unfold_locally(const DiscGeometry& disc, std::vector<Vec2>& plane);

}  // namespace applique
