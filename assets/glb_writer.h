#pragma once

#include <filesystem>
#include <string>

#include "applique/base/error.h"
#include "applique/image/image.h"

#include "mesh.h"

namespace applique::assets {

/// What a GLB needs besides its mesh: one node, one mesh, one material with a base-colour texture.
struct GlbOptions {
  std::string name;  ///< Of the node, the mesh and the material.
  double roughness = 0.6;
  double metallic = 0.0;
};

/// Writes the mesh (with normals and uvs) and its texture, as PNG inside, to `path`.
Result<void> write_glb(const std::filesystem::path& path, const Mesh& mesh, const Image& texture,
                       const GlbOptions& options);

/// Writes bytes to a file, or says why not.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace applique::assets
