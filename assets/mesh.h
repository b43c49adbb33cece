#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/types.h"

namespace applique::assets {

using Triangle = std::array<std::uint32_t, 3>;

/// A triangle mesh, counter-clockwise seen from outside. `uvs` is glTF's: origin at the texture's top left,
/// v down; empty before unwrapping.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<Eigen::Vector2d> uvs;
  std::vector<Triangle> triangles;
};

}  // namespace applique::assets
