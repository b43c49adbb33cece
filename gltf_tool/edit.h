#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "document.h"
#include "material.h"

namespace applique {

/// A primitive of a mesh where one node shows it.
struct PartKey {
  std::size_t node = 0;
  std::size_t mesh = 0;
  std::size_t primitive = 0;
  bool every_node = false;  ///< It stands for all nodes that show the mesh and have no part in the list.
};

/// For each part, which of its mesh's instances among the parts it belongs to: 0 for the first node, and so
/// on.
std::vector<std::size_t> instance_ranks(std::span<const PartKey> parts);

/// Makes the material of each given part (all that a decal touches) one that nothing else uses, and returns
/// its index, by part. A mesh that other nodes show too is copied for the node (accessors stay shared), but
/// not for a part that stands for all of them; a material that other primitives, or their variants, use is
/// copied; a part without a material gets one. Variants of a part that show its material go on showing what
/// it has. Parts that shared a material go on sharing it, unless they are instances of one mesh, whose
/// texture coordinates would coincide. The document must have passed check_document; the parts are distinct
/// and exist.
std::vector<std::size_t> isolate_materials(Document& document, std::span<const PartKey> parts);

/// Leads a primitive's variants (KHR_materials_variants) that show one material to another.
void lead_variants(Document::Json& primitive, std::size_t from, std::size_t to);

/// Shows an image (bytes of a PNG, JPEG or WebP) in a slot of an isolated material. The texture is copied
/// first when other materials or slots use it; its sampler, and the material's texture coordinates, stay. A
/// material without a texture there gets one over the base colour's coordinates (TEXCOORD_0 without a base
/// colour). Where there was no image before, the slot's factors become 1, so the image must have them in its
/// values. The replaced image's bytes go where nothing else uses them. A WebP is shown by EXT_texture_webp,
/// which the document then requires: a second image beside it would cost more than it saves.
void set_slot_image(Document& document, std::size_t material, MaterialSlot slot,
                    std::span<const std::uint8_t> bytes);

/// A texture reference in a material: /normalTexture, /extensions/KHR_materials_clearcoat/clearcoatTexture.
using SlotPointer = Document::Json::json_pointer;

/// Shows an image (bytes of a PNG, JPEG or WebP) in some slots of an isolated material that show one texture
/// so far. The texture is copied first when others use it; its sampler, and the slots' texture coordinates,
/// stay. `name` is for a new image.
void set_slot_images(Document& document, std::size_t material, const std::vector<SlotPointer>& slots,
                     std::span<const std::uint8_t> bytes, const std::string& name);

/// Adds an image of PNG, JPEG or WebP bytes: in the chunk of a GLB, else as a new file named after `name`.
/// Returns its index.
std::size_t add_image(Document& document, std::span<const std::uint8_t> bytes, const std::string& name);

/// Adds a file of the document's own, named after `name`; returns its URI.
std::string add_file(Document& document, std::span<const std::uint8_t> bytes, const std::string& name);

/// Makes an image the only one that a texture shows, by the extension that its kind needs.
void show_image(Document& document, std::size_t texture, std::size_t image);

}  // namespace applique
