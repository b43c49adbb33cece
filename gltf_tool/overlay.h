#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "document.h"

namespace applique {

/// A decal as a mesh of its own, in scene space.
struct OverlayMesh {
  std::string name;
  std::vector<std::array<float, 3>> positions;  ///< Scene space at the rest pose.
  std::vector<std::array<float, 3>> normals;    ///< Unit, one per position.
  std::vector<std::array<float, 2>> uvs;  ///< Image coordinates over the image's size, one per position.
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< Counter-clockwise seen from outside; at least one.
};

/// Adds the overlay to the default scene: mesh and node named after it with `extras.applique.decal`, the
/// image (PNG bytes) as base colour with alpha blending, times `opacity`. Returns the node's index.
std::size_t add_overlay(Document& document, const OverlayMesh& overlay, std::span<const std::uint8_t> png,
                        double opacity);

}  // namespace applique
