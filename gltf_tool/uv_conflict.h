#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "applique/base/error.h"

#include "solve_job.h"
#include "uv_layout.h"

namespace applique {

/// The triangles that show some of a baked decal, each once, under the lowest of its sheets.
std::vector<SeparatedTriangle> touched_triangles(const SolvedJob& job, std::size_t decal);

/// Parts of the model that show one texture and stay together in a bake, and the decals on them.
struct TextureGroup {
  std::optional<std::size_t> material;
  std::vector<std::uint32_t> parts;     ///< Indices in Model::parts, ascending.
  std::array<int, 2> texture = {0, 0};  ///< Texels of its base colour; of the one that a bake would make.
  bool has_texture = false;
};

/// The groups that the job's baked decals touch. Errors: those of load_model_image.
Result<std::vector<TextureGroup>> find_texture_groups(const SolvedJob& job);

/// How a decal's triangles stand in the texture of a group.
struct UvState {
  std::vector<SeparatedTriangle> triangles;  ///< Those in the group.
  std::uint64_t covered_texels = 0;
  std::uint64_t shared_texels = 0;  ///< Covered by several triangles of the group.
  double pixels = 0;                ///< Of the decal's image.
  double lost_pixels = 0;           ///< On triangles with texture coordinates that are not fit for a decal.
  bool without_uvs = false;         ///< Some have no texture coordinates.

  /// Whether the decal cannot be baked there, or not without being seen elsewhere.
  [[nodiscard]] bool conflicts() const;
};

/// The state of each decal of the job in the group.
std::vector<UvState> find_uv_states(const SolvedJob& job, const TextureGroup& group);

}  // namespace applique
