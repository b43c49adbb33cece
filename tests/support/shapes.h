#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "applique/surface/surface_mesh.h"

namespace applique::shapes {

/// A triangle soup, as a file would hold it.
struct Soup {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  [[nodiscard]] SurfaceMesh weld() const { return weld_surface(positions, triangles); }
};

/// A grid of (columns x rows) quads over the parameters [0,1]^2, mapped by `point`; diagonals alternate.
Soup grid(int columns, int rows, const std::function<Vec3(double, double)>& point);

/// [0, width] x [0, height] in the xy plane, outside is +z. `jitter` moves inner vertices, share of a cell.
Soup plane(int columns, int rows, double width, double height, double jitter = 0, std::uint32_t seed = 1);

/// A tube round the z axis, open at both ends, outside outward; closed round (no seam after welding).
Soup cylinder(int around, int along, double radius, double height);

/// A sphere from a subdivided icosahedron: 20 * 4^levels triangles.
Soup sphere(int levels, double radius);

Soup torus(int around, int across, double major, double minor);

/// The plane [-1,1]^2 with a bump of the given height and width in the middle.
Soup bump(int cells, double height, double width);

/// The Menger sponge of the given level in [-1,1]^3: tunnels all over. `parts` squares to an edge of its
/// cubes.
Soup sponge(int level, int parts);

/// Gentle hills over [-1,1]^2 and a place of them: nowhere developable, and flattened without a fold.
Soup hills(int cells);
Vec3 hills_at(double x, double y);

/// The surface point nearest to `position`, by trying all faces.
SurfacePoint nearest(const SurfaceMesh& mesh, const Vec3& position);

}  // namespace applique::shapes
