#pragma once

#include <vector>

#include "applique/base/types.h"
#include "applique/patch/immersed_disc.h"

namespace applique {

/// Where the map of some vertices leads the others: the third corner of a triangle whose other two are placed
/// goes where the similarity of that edge takes it. Places every vertex that is connected with placed ones,
/// so that `placed` is true of them; the paper leaves new vertices without a place until they are embedded,
/// which an iterative solver cannot do (§5.1). By vertex, dead ones are left alone.
void continue_map(const ImmersedDisc& disc, std::vector<char>& placed, std::vector<Vec2>& map);

}  // namespace applique
