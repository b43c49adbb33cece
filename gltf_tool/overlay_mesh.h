#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model.h"
#include "solve_job.h"

namespace applique {

/// A decal as triangles of its own, in scene space at the rest pose.
struct DecalMesh {
  /// The place of a vertex on the patch: within a face, weights of its corners, which sum to 1.
  struct Origin {
    std::array<PatchVertexId, 3> vertices;  ///< Valid where the weight is not 0.
    std::array<double, 3> weights = {0, 0, 0};
  };

  std::vector<Vec3> positions;
  std::vector<Vec3> normals;               ///< Unit: the surface's, as viewers shade it.
  std::vector<Vec3> directions;            ///< Unit: in which it lies above the surface; one at each place.
  std::vector<std::array<double, 2>> uvs;  ///< Image pixels divided by the image's size: [0, 1], v down.
  std::vector<double> heights;             ///< Above the surface, scene units.
  std::vector<Origin> origins;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise seen from outside.
  std::vector<PatchFaceId> faces;                       ///< By triangle: the patch face that it is a part of.
};

/// Lays the decal's faces out as a mesh: those that meet the region, divided until the linear texture
/// coordinates of every triangle lie within `max_deviation` pixels of the exact map (edges are divided for
/// both their faces at once, so no crack opens; up to some ten thousand triangles, or four times as many
/// as there were, which only an image that is torn to pieces takes), cut at the image's border, and moved by
/// `offset` (scene units, >= 0) along the area-weighted mean of the model's normals at a vertex: so nothing
/// tears where the model has an edge. There the mesh has several vertices at one place, each with the normal
/// of the surface under its triangles.
///
/// Where the region overlaps itself, sheet after sheet follows from the bottom up, and each lies one more
/// `offset` above the surface. Where faces of several sheets meet, their vertices go with the highest, so
/// that nothing tears; a lower sheet then rises to the upper one there.
DecalMesh build_overlay_mesh(const Model& model, const SolvedDecal& decal, double offset,
                             double max_deviation = 0.25);

/// The weights of the corners of the source triangle under `face` at a place within that patch face.
std::array<double, 3> weights_in_source(const SolvedDecal& decal, const DecalMesh::Origin& origin,
                                        PatchFaceId face);

/// The faces that meet the region as they are, undivided and uncut; their texture coordinates, at the corners
/// exact, go beyond [0, 1] where they stick out of the image. Else as build_overlay_mesh.
DecalMesh build_whole_mesh(const Model& model, const SolvedDecal& decal, double offset);

/// Whether the linear texture coordinates of the undivided faces lie within `max_deviation` pixels of the
/// exact map.
bool is_linear(const Model& model, const SolvedDecal& decal, double max_deviation = 0.25);

/// The offset of an overlay for which the job names none: 0.05 % of the model's diagonal.
double default_offset(const Model& model);

}  // namespace applique
