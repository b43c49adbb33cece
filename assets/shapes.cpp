#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace applique::assets {
namespace {

constexpr double drum_radius = 0.5;
constexpr double drum_half_height = 0.6;
constexpr double stairs_width = 1.6;
constexpr double step_size = 0.4;
constexpr int step_count = 3;
constexpr double stairs_length = 2 * step_count * step_size;

/// A rectangle of `columns` x `rows` squares bent into shape; u to the right, v down, both 0 to 1.
Mesh bend_sheet(int columns, int rows, const std::function<Vec3(double u, double v)>& position,
                const std::function<Vec3(double u, double v)>& normal) {
  Mesh mesh;
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column) {
      const double u = static_cast<double>(column) / columns, v = static_cast<double>(row) / rows;
      mesh.positions.push_back(position(u, v));
      mesh.normals.push_back(normal(u, v));
      mesh.uvs.emplace_back(u, v);
    }
  const auto at = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * (columns + 1) + column);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      // Diagonals alternate, so that no direction is better than its mirror image.
      const std::uint32_t a = at(column, row), b = at(column, row + 1), c = at(column + 1, row + 1),
                          d = at(column + 1, row);
      if ((row + column) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  return mesh;
}

/// Pale plaster, a little cloudy.
Colour plaster(const Vec3& position, const Vec3&, double) {
  const double clouds = fractal_noise(3.0 * position, 4) + 0.3 * noise(60 * position);
  return (1 + 0.03 * clouds) * Colour(0.86, 0.85, 0.82);
}

Model painted(Mesh mesh, int texture_size) {
  Model model;
  model.mesh = std::move(mesh);
  model.texture = paint_texture(model.mesh, {}, texture_size, plaster);
  return model;
}

}  // namespace

Vec3 drum_point(double turn, double y) {
  return {drum_radius * std::sin(turn), y, drum_radius * std::cos(turn)};
}

Model make_drum(int texture_size) {
  constexpr int sides = 96, rings = 36;
  // Both ends of a ring are the seam, bit for bit.
  const auto turn_of = [](double u) { return 2 * std::numbers::pi * ((u < 1 ? u : 0) - 0.5); };
  return painted(
      bend_sheet(
          sides, rings,
          [&](double u, double v) { return drum_point(turn_of(u), drum_half_height * (1 - 2 * v)); },
          [&](double u, double) { return Vec3(drum_point(turn_of(u), 0).normalized()); }),
      texture_size);
}

Vec3 stairs_point(double along, double x) {
  const double half_length = 0.5 * step_count * step_size;
  const double at = std::clamp(along / step_size, 0.0, 2.0 * step_count);
  const double whole = std::floor(at);
  const bool rising = static_cast<int>(whole) % 2 == 0;
  const double risers = std::ceil(0.5 * whole) + (rising ? at - whole : 0);
  const double treads = std::floor(0.5 * whole) + (rising ? 0 : at - whole);
  return {x, step_size * risers - half_length, half_length - step_size * treads};
}

Model make_stairs(int texture_size) {
  // Corners lie on rows of vertices; normals are the faces' own but for the rows at the edges.
  constexpr int rows_a_face = 10, faces = 2 * step_count;
  const auto along = [](double v) { return stairs_length * (1 - v); };
  Mesh mesh = bend_sheet(
      40, faces * rows_a_face,
      [&](double u, double v) { return stairs_point(along(v), stairs_width * (u - 0.5)); },
      [&](double, double v) {
        constexpr double near = 1e-6;
        const Vec3 way = stairs_point(along(v) + near, 0) - stairs_point(along(v) - near, 0);
        return Vec3(Vec3::UnitX().cross(way).normalized());
      });
  return painted(std::move(mesh), texture_size);
}

}  // namespace applique::assets
