#include "applique/gpu/camera.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace applique {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

// Columns: right, up, towards the viewer.
Eigen::Matrix3d view_axes(const Vec3& backward, const Vec3& up) {
  const Vec3 z = backward.normalized();
  Vec3 x = up.cross(z);
  if (x.norm() < 1e-9 * up.norm()) x = (std::abs(z.y()) > 0.9 ? Vec3(0, 0, -z.y()) : Vec3(0, 1, 0)).cross(z);
  x.normalize();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return axes;
}

}  // namespace

Camera orbit(const Vec3& centre, double radius, double azimuth, double elevation, double zoom) {
  Camera camera;
  const double a = azimuth * degree, e = elevation * degree;
  const Vec3 direction{std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
  camera.target = centre;
  camera.eye = centre + direction * (radius / (std::sin(0.5 * camera.vertical_fov * degree) * zoom));
  // The way up the sphere, which stays defined at its poles.
  camera.up = {-std::sin(e) * std::sin(a), std::cos(e), -std::sin(e) * std::cos(a)};
  return camera;
}

Camera frame_points(std::span<const Vec3> points, const Vec3& direction, const Vec3& up, double aspect,
                    double margin) {
  Camera camera;
  camera.up = up;
  const Eigen::Matrix3d axes = view_axes(direction, up);
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(Vec3(axes.transpose() * point));
  const Vec3 centre = points.empty() ? Vec3(0, 0, 0) : box.center();
  const double tangent = std::tan(0.5 * camera.vertical_fov * degree) * (1 - 2 * margin);
  double distance = 1e-6;
  for (const Vec3& point : points) {
    const Vec3 p = axes.transpose() * point - centre;
    distance =
        std::max({distance, p.z() + std::abs(p.x()) / (tangent * aspect), p.z() + std::abs(p.y()) / tangent});
  }
  camera.target = axes * centre;
  camera.eye = camera.target + distance * axes.col(2);
  return camera;
}

Eigen::Matrix4d view_projection(const Camera& camera, double aspect, double near, double far) {
  const Eigen::Matrix3d axes = view_axes(camera.eye - camera.target, camera.up);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = axes.transpose();
  view.topRightCorner<3, 1>() = -axes.transpose() * camera.eye;
  const double scale = 1 / std::tan(0.5 * camera.vertical_fov * degree);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = scale / aspect;
  projection(1, 1) = -scale;
  projection(2, 2) = far / (near - far);
  projection(2, 3) = near * far / (near - far);
  projection(3, 2) = -1;
  return projection * view;
}

}  // namespace applique
