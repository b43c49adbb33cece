#pragma once

#include "compare/comparison.h"
#include "compare/patch_file.h"

namespace applique::compare {

/// The map that another program's texture coordinates make of a patch, as a DecalMap without a warp, measured
/// like any other. Vertices are matched by position to the surface's; one that the other program split along
/// a seam has an image point for each side. The coordinates are brought to the image by the similarity that
/// keeps the first pin exact and brings the others nearest to their image points in the least squares; with
/// one pin, that brings the vertices nearest to those of `ours`, the default's map. Mirrored coordinates stay
/// mirrored: they count as flips. Errors: model_invalid, when a vertex is not one of the surface or a
/// triangle is not one of its faces.
Result<DecalMap> external_map(const Site& site, const DecalInput& input, const DecalMap& ours,
                              const PatchFile& file);

/// The row of `method` for the file, whose node names a case of the comparison, with its map. Errors: those
/// of read_patch, external_map and solve_decal; option_invalid when there is no such case.
Result<Row> measure_external(const Comparison& comparison, const std::string& method,
                             const std::filesystem::path& file);

}  // namespace applique::compare
