#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "applique/decal.h"

#include "compare/sites.h"

/// Patches as GLB files, for other programs to parameterize.
namespace applique::compare {

/// Writes the part of the patch that is on the surface, one primitive: POSITION in scene units; TEXCOORD_0
/// the image point in pixels over the image's size (v down). Vertex i is the patch's i-th vertex that is over
/// a surface vertex, triangles are in the patch's order. The node is named after the case. Errors:
/// output_unwritable.
Result<void> write_patch(const std::filesystem::path& path, const std::string& name, const Site& site,
                         const DecalMap& map, const ImageFrame& frame);

/// A patch with texture coordinates by another program.
struct PatchFile {
  std::string name;                                     ///< Of the node: the case.
  std::vector<Vec3> positions;                          ///< Scene units.
  std::vector<std::array<double, 2>> uvs;               ///< One per position, v down.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Of all primitives.
};

/// Errors: those of load_model; model_invalid when the file has no triangles or no TEXCOORD_0.
Result<PatchFile> read_patch(const std::filesystem::path& path);

}  // namespace applique::compare
