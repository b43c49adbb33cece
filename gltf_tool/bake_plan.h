#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

#include "report.h"
#include "solve_job.h"

namespace applique {

/// A base-colour texture that a job bakes into: that of one material on the parts of the model that decals
/// touch. Parts that show one mesh twice (two nodes) get a texture each.
struct BakeTarget {
  std::size_t isolated = 0;             ///< The material in the edited document; nothing else uses it.
  std::optional<std::size_t> material;  ///< The material in the model, before; none: the parts had none.
  std::vector<std::uint32_t> parts;  ///< Indices in Model::parts, ascending: all that is to show the texture.
  std::vector<std::size_t> decals;   ///< Indices in SolvedJob::decals, ascending: all that lie on the parts.
};

/// The textures that the job's baked decals (not its overlays) need. `document`, a copy of the model's, gets
/// the isolated materials. Errors: uvs_missing, naming the decal and the mesh, for a touched part without
/// texture coordinates.
Result<std::vector<BakeTarget>> plan_bake(const SolvedJob& job, Document& document);

/// The texture as it is before: the material's own, or one of the base-colour factor's colour. Errors: those
/// of load_model_image.
Result<Image> initial_texture(const SolvedJob& job, const BakeTarget& target);

/// Whether the target's material has a base-colour image.
bool has_texture(const Model& model, const BakeTarget& target);

/// The share of a decal in a texture of `width` x `height` texels. Its warp points into the decal; its image
/// is left to the caller.
Transfer lay_out_transfer(const SolvedJob& job, const BakeTarget& target, std::size_t decal, int width,
                          int height);

/// How finely the transfers resolve the decal: they share its faces out between the textures. None if it has
/// none.
std::optional<TexelDensity> texel_density(const SolvedDecal& decal,
                                          const std::vector<const Transfer*>& transfers);

}  // namespace applique
