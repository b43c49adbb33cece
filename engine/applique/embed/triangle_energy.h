#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "applique/base/types.h"

namespace applique {

/// Places in the plane, one per vertex.
using PlanePoints = Eigen::VectorXcd;

/// A triangle at rest: its area, and half the gradients of its corners' hat functions.
struct RestTriangle {
  double area;
  std::array<Vec2, 3> hat;

  /// `corners` counter-clockwise.
  explicit RestTriangle(const std::array<Vec2, 3>& corners)
      : area(0.5 * cross(corners[1] - corners[0], corners[2] - corners[0])) {
    for (int k = 0; k < 3; ++k) hat[k] = Vec2(0, 0.25) * (corners[(k + 2) % 3] - corners[(k + 1) % 3]) / area;
  }
};

/// A triangle's map z -> a z + b conj(z): it stretches by |a| + |b| and |a| - |b|, and areas by the product.
struct TriangleMap {
  Vec2 a = 0, b = 0;

  TriangleMap(const RestTriangle& rest, const std::array<int, 3>& f, const PlanePoints& plane) {
    for (int k = 0; k < 3; ++k) {
      a += plane[f[k]] * std::conj(rest.hat[k]);
      b += plane[f[k]] * rest.hat[k];
    }
  }

  /// The product of the two stretches, and the mean of their squares.
  [[nodiscard]] double det() const { return std::norm(a) - std::norm(b); }
  [[nodiscard]] double mean_square() const { return std::norm(a) + std::norm(b); }
};

/// What an energy makes of a triangle: its value per area, and the derivatives of that.
struct EnergyDensity {
  double value, by_mean_square, by_det;
};

/// The sum over the triangles of area times density(mean_square, det), and its gradient as complex numbers;
/// infinite where a value is.
template <class Density>
double triangle_energy(std::span<const std::array<int, 3>> faces, std::span<const RestTriangle> rest,
                       const PlanePoints& plane, const Density& density, PlanePoints& gradient) {
  double sum = 0;
  gradient.setZero(plane.size());
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const TriangleMap map(rest[t], faces[t], plane);
    const EnergyDensity at = density(map.mean_square(), map.det());
    if (!(at.value < std::numeric_limits<double>::infinity())) return std::numeric_limits<double>::infinity();
    sum += rest[t].area * at.value;
    const Vec2 by_a = 2 * rest[t].area * (at.by_mean_square + at.by_det) * map.a;
    const Vec2 by_b = 2 * rest[t].area * (at.by_mean_square - at.by_det) * map.b;
    for (int k = 0; k < 3; ++k)
      gradient[faces[t][k]] += by_a * rest[t].hat[k] + by_b * std::conj(rest[t].hat[k]);
  }
  return sum;
}

}  // namespace applique
