#pragma once

#include <span>

#include <Eigen/Core>

#include "applique/base/types.h"

namespace applique {

/// A perspective camera. `up` need not be perpendicular to the view, only not along it.
struct Camera {
  Vec3 eye = {0, 0, 1};
  Vec3 target = {0, 0, 0};
  Vec3 up = {0, 1, 0};
  double vertical_fov = 30;  ///< Degrees, between the picture's lower and upper edge.
};

/// Looks at a sphere that fills the picture's height at zoom 1, its picture `zoom` times as large otherwise.
/// Azimuth 0 looks from +z, 90 from +x; elevation 90 from above (+y). Degrees.
Camera orbit(const Vec3& centre, double radius, double azimuth, double elevation, double zoom = 1);

/// Looks at points from `direction` (from them to the camera, any length > 0), as near as the picture of the
/// given aspect (width / height) holds them all with `margin` (a share of the picture) around them.
Camera frame_points(std::span<const Vec3> points, const Vec3& direction, const Vec3& up, double aspect,
                    double margin = 0.08);

/// From the scene to Vulkan's clip space (y down, depth 0 to 1), for points between the distances `near` and
/// `far` from the eye.
Eigen::Matrix4d view_projection(const Camera& camera, double aspect, double near, double far);

}  // namespace applique
