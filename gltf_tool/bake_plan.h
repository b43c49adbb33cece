#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

#include "material.h"
#include "report.h"
#include "solve_job.h"

namespace applique {

/// A decal's layer, by its index in SolvedJob::decals and in DecalJob::layers.
struct BakeShare {
  std::size_t decal;
  std::size_t layer;
};

/// A texture that a job bakes into: that of one material's slot on the parts of the model that decals touch.
/// Parts that show one mesh twice (two nodes) get a texture each.
struct BakeTarget {
  MaterialSlot slot = MaterialSlot::base_color;
  std::size_t isolated = 0;             ///< The material in the edited document; nothing else uses it.
  std::optional<std::size_t> material;  ///< The material in the model, before; none: the parts had none.
  std::vector<std::uint32_t> parts;  ///< Indices in Model::parts, ascending: all that is to show the texture.
  std::vector<BakeShare>
      shares;  ///< All that lie on the parts and have a layer for the slot, in the job's order.
};

/// A part's texture coordinates for a slot, as ModelPart::uvs are those of the base colour; empty: none.
std::vector<std::array<double, 2>> slot_uvs(const Model& model, const ModelPart& part, MaterialSlot slot);
/// The same through the mapping of any texture of its material.
std::vector<std::array<double, 2>> uvs_through(const Model& model, const ModelPart& part,
                                               const UvMapping& mapping);

/// Texels of a slot's texture on a material of the model, without decoding it; of the one that a bake would
/// make for it. Errors: those of load_model_image, of the image's header.
Result<std::array<int, 2>> slot_texture_size(const SolvedJob& job, std::optional<std::size_t> material,
                                             MaterialSlot slot);

/// The textures that the layers of the job's baked decals (not its overlays) need. `document`, a copy of the
/// model's, gets the isolated materials. Errors: uvs_missing, naming the decal and the mesh, for a touched
/// part without texture coordinates.
Result<std::vector<BakeTarget>> plan_bake(const SolvedJob& job, Document& document);

/// The texture as it is before: the material's own, or one of the values that its factors give (1 in channels
/// that nothing reads, a flat normal). Errors: those of load_model_image.
Result<Image> initial_texture(const SolvedJob& job, const BakeTarget& target);

/// A texture of the values that a material's factors give in a slot.
Image texture_of_factors(const SolvedJob& job, std::optional<std::size_t> material, MaterialSlot slot,
                         const std::array<int, 2>& size);

/// Whether the target's slot has an image.
bool has_texture(const Model& model, const BakeTarget& target);

/// What a decal puts into a texture.
struct BakeTransfer : Transfer {
  std::size_t own = 0;  ///< So many faces, the first, are the decal's; the others' place is left to other
                        ///< triangles that share it (SolvedJob::former).
};

/// A layer's share in a texture of `width` x `height` texels. Its warp points into the decal; its image is
/// left to the caller.
BakeTransfer lay_out_transfer(const SolvedJob& job, const BakeTarget& target, const BakeShare& share,
                              int width, int height);

/// How finely the transfers resolve the decal: they share its faces out between the textures. None if it has
/// none.
std::optional<TexelDensity> texel_density(const SolvedDecal& decal,
                                          const std::vector<const BakeTransfer*>& transfers);

}  // namespace applique
