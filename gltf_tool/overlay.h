#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "applique/base/types.h"

#include "document.h"

namespace applique {

/// A decal as triangles of its own, in scene space.
struct OverlayMesh {
  std::vector<Vec3> positions;             ///< At the rest pose.
  std::vector<Vec3> normals;               ///< Unit.
  std::vector<std::array<double, 2>> uvs;  ///< Image pixels divided by the image's size: [0, 1], v down.
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< Counter-clockwise seen from outside; at least one.
};

/// Adds an overlay to the default scene: a mesh and a node named after the decal, with
/// `extras.applique.decal`, and a material that shows the image (bytes of a PNG, JPEG or WebP) with alpha
/// blending. Returns the node's index.
std::size_t add_overlay(Document& document, const std::string& decal, const OverlayMesh& overlay,
                        std::span<const std::uint8_t> image_bytes);

}  // namespace applique
