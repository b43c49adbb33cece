#pragma once

#include <complex>
#include <cstdint>

#include <Eigen/Geometry>

namespace applique {

/// A point or vector of space, in the scene's units.
using Vec3 = Eigen::Vector3d;

/// A point or vector of the decal's plane, as a complex number: x right, y up, image units (see ImageFrame).
using Vec2 = std::complex<double>;

/// A point of an image in pixels: origin at the image's top-left corner, x right, y down, the first pixel's
/// centre at (0.5, 0.5).
struct Pixel {
  double x = 0;
  double y = 0;
};

/// 2-D cross product: positive when b lies counter-clockwise of a.
inline double cross(Vec2 a, Vec2 b) {
  return a.real() * b.imag() - a.imag() * b.real();
}
inline double dot(Vec2 a, Vec2 b) {
  return a.real() * b.real() + a.imag() * b.imag();
}

}  // namespace applique
