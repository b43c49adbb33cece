#pragma once

#include <vector>

#include "applique/base/error.h"
#include "applique/decal.h"
#include "applique/embed/align.h"
#include "applique/patch/immersed_disc.h"

namespace applique {

/// The similarity that gives a lone feature's neighbourhood in the embedding the size and direction that
/// `input.lone` asks for, and takes the feature to its image point (§3.3 of the design). `feature`: where it
/// is in `plane`, in `feature_face`; `target`: its image point. Errors: size_missing, not_solved.
Result<Similarity> lone_alignment(const SurfaceMesh& surface, const DecalInput& input,
                                  const ImmersedDisc& disc, PatchFaceId feature_face, Vec2 feature,
                                  Vec2 target, const std::vector<Vec2>& plane);

}  // namespace applique
