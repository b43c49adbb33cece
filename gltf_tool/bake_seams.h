#pragma once

#include <array>
#include <span>
#include <vector>

#include "applique/transfer/seams.h"

#include "bake_plan.h"

namespace applique {

/// A target and the size of its texture, texels.
struct SizedTarget {
  const BakeTarget* target;
  int width;
  int height;
};

/// Where the job's decals cross from one texture island to another, or from one texture to another: a Seam's
/// texture is an index in `targets`, which are all those of one slot. Parts of a decal under others of its
/// own are left out.
std::vector<Seam> find_seams(const SolvedJob& job, std::span<const SizedTarget> targets);

}  // namespace applique
