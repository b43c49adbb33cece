#pragma once

#include <vector>

#include "applique/embed/disc_geometry.h"

namespace applique {

struct ArapOptions {
  int max_iterations = 30;
  double tolerance = 1e-4;  ///< Stops when no vertex moves by more than this share of the mean edge length.
};

/// As-rigid-as-possible parameterization (Liu et al. 2008) by local and global steps from `start`, which must
/// be of the disc's own scale. Cuts the area distortion of a conformal start. May fold: see embed_disc.
std::vector<Vec2> relax_arap(const DiscGeometry& disc, std::vector<Vec2> start,
                             const ArapOptions& options = {});

}  // namespace applique
