#pragma once

#include <vector>

#include "applique/base/types.h"

#include "solve_job.h"

namespace applique {

/// How to look at a decal: what a camera must hold, from where, which way up.
struct DecalView {
  std::vector<Vec3> points;  ///< The decal's outline and inside, on the surface.
  Vec3 towards_viewer;       ///< Unit: the area-weighted mean normal of the decal.
  Vec3 up;                   ///< Unit, across `towards_viewer`: up in the image, on the surface.
};

/// The decal has at least one textured face.
DecalView view_of_decal(const SolvedDecal& decal);

}  // namespace applique
