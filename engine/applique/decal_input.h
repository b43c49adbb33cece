#pragma once

#include <string>
#include <vector>

#include "applique/decal.h"

namespace applique {

/// How messages call feature k: "feature 3 at (120.5, 88.0)".
std::string feature_name(const DecalInput& input, std::size_t k);

/// Whether to check the patch's invariants: always in builds that are for it (APPLIQUE_CHECK_INVARIANTS).
bool checks_patch(const SolveOptions& options);

/// The features' image points in the plane.
std::vector<Vec2> targets_of(const DecalInput& input);

/// What to add to an error that tells of a surface that is not as its maker may think: where the weld cut it
/// open or left triangles out (begins with "; "). Empty where it did not.
std::string weld_note(const SurfaceMesh& surface);

/// The features_mirrored of a decal whose features run one way round in the image and the other way round on
/// the surface.
tl::unexpected<Error> fail_mirrored(const SurfaceMesh& surface, const DecalInput& input);

/// What every method asks of its input. `targets`: the features' image points in the plane. Features may
/// share a spot of the surface, not of the image, where the decal may lie over itself. Errors, each naming
/// the decal and the features: feature_place_invalid, feature_outside_region, features_coincide,
/// size_missing, features_disconnected.
Result<void> check_input(const SurfaceMesh& surface, const DecalInput& input,
                         const std::vector<Vec2>& targets, Overlap overlap = Overlap::stop);

/// The direction of a lone feature's "up" along the surface, unit, where the unit normal is `normal`. Error:
/// size_missing when it has none.
Result<Vec3> lone_up(const DecalInput& input, const Vec3& normal);
/// Plane units per scene unit at a lone feature.
double lone_scale(const DecalInput& input);
/// Turns down a map that shows next to nothing of the region (not_solved).
Result<void> check_coverage(const DecalInput& input, double coverage);

}  // namespace applique
