#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "applique/base/types.h"

#include "document.h"
#include "material.h"
#include "rig.h"

namespace applique {

/// The part of a decal that lies on one node, as triangles of its own.
struct OverlayMesh {
  std::optional<std::size_t> node;  ///< The node it moves with; none: it stays where the scene is at rest.
  std::vector<Vec3> positions;      ///< In the space of the node's mesh, or in scene space. By `mirrored`.
  std::vector<Vec3> normals;        ///< Unit, likewise.
  std::vector<std::array<double, 2>> uvs;  ///< In the pictures: [0, 1] and around it, v down.
  /// As glTF stores them; empty: none, and viewers make them.
  std::vector<std::array<float, 4>> tangents;
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< At least one; counter-clockwise seen from outside.
  /// The node mirrors what it moves. Its overlay has x turned over, in a node that turns it back: so nothing
  /// is mirrored, and tangents mean the same to all viewers. A skin moves its vertices without the node.
  bool mirrored = false;
  bool joints_mirror = false;             ///< Where viewers differ in what the sign of a tangent means.
  std::size_t influences_per_vertex = 0;  ///< A multiple of 4; 0: no skin.
  std::vector<Influence> influences;  ///< By vertex, the heaviest first; the weights sum to 1, or are all 0.
  std::vector<MorphTarget> targets;   ///< As many as the node's mesh has.
};

/// What an overlay shows: textures by slot (bytes of a PNG, JPEG or WebP), the base colour's among them, and
/// factors.
struct OverlayMaterial {
  std::map<MaterialSlot, std::vector<std::uint8_t>> textures;
  double metallic = 0;
  double roughness = 1;
  std::array<double, 3> emissive = {0, 0, 0};  ///< Linear light.
  std::vector<std::string> layers;             ///< The decal's layers, as "layers" calls them.
};

/// Adds a material with alpha blending, with `extras.applique.layers`. Returns its index.
std::size_t add_overlay_material(Document& document, const std::string& decal,
                                 const OverlayMaterial& material);

/// Adds an overlay: a mesh and a node named after the decal, with `extras.applique.decal`. It is a child of
/// the node that it follows, or a root of the default scene: with the node's skin where that has one, still
/// where it follows none. Animations that drive the node's morph targets drive the overlay's. Returns the new
/// node's index.
std::size_t add_overlay(Document& document, const std::string& decal, const OverlayMesh& overlay,
                        std::size_t material);

}  // namespace applique
