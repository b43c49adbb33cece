#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "model.h"

namespace applique {

/// The tangent frames of a part's triangles, by triangle and corner, that a viewer takes its normal map's
/// vectors to be in: the file's where it has them, else those of MikkTSpace (Mikkelsen 2008, which glTF
/// prescribes): of the triangles about a vertex (one position, normal and texture coordinate) that are not
/// mirrored against one another, the mean of the texture's u direction in the vertex's tangent plane,
/// weighted by angle. Tangents run with u; bitangents, the sign times normal x tangent, run against v, which
/// points down. `uvs` by vertex, of the normal texture.
std::vector<std::array<Tangent, 3>> tangent_frames(const ModelPart& part,
                                                   std::span<const std::array<double, 2>> uvs);

/// Where a normal map's vectors point at a place in a triangle: +x along the tangent, +y along the bitangent,
/// +z along the normal; unit.
struct NormalMapFrame {
  Vec3 tangent, bitangent, normal;
};
/// `frames`: the triangle's of tangent_frames(); `weights`: of its corners.
NormalMapFrame frame_inside(const ModelPart& part, std::size_t triangle, const std::array<Tangent, 3>& frames,
                            const std::array<double, 3>& weights);

/// The frames by vertex, as glTF stores them: a unit tangent and its sign. None where the triangles about a
/// vertex differ in the sign.
std::optional<std::vector<std::array<float, 4>>> vertex_tangents(
    const ModelPart& part, const std::vector<std::array<Tangent, 3>>& frames);

}  // namespace applique
