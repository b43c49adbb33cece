#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/error.h"
#include "applique/gpu/camera.h"
#include "applique/gpu/device.h"
#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

namespace applique {

/// How a mesh uses the alpha of its base colour, as in glTF.
enum class AlphaMode : std::uint32_t { opaque, mask, blend };

/// Triangles with one material, in scene space.
struct RenderMesh {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> normals;            ///< Unit, one per position; empty or zero: flat.
  std::vector<std::array<float, 2>> uvs;                ///< v down, one per position; empty: no texture.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise seen from outside.
  const Image* base_colour = nullptr;                   ///< Null: white.
  const Image* metallic_roughness = nullptr;  ///< Roughness in green, metallic in blue. Null: white.
  const Image* normal = nullptr;              ///< Tangent space, as in glTF. Null: no relief.
  const Image* emissive = nullptr;            ///< Null: white.
  std::array<float, 4> base_colour_factor = {1, 1, 1, 1};  ///< Linear light.
  float metallic = 0;
  float roughness = 0.447F;  ///< A slight gloss.
  float normal_scale = 1;
  std::array<float, 3> emissive_factor = {0, 0, 0};  ///< Linear light.
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = false;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
};

struct RenderOptions {
  int width = 1024;   ///< Pixels, 1 to what the device can render to (4096 at least).
  int height = 1024;  ///< Pixels.
  std::array<float, 3> background_top = {0.90F, 0.91F, 0.93F};  ///< sRGB, 0 to 1.
  std::array<float, 3> background_bottom = {0.66F, 0.68F, 0.72F};
};

/// Draws meshes before a soft gradient, lit by a key light over the camera's left shoulder, a fill, a rim and
/// the sky, without a display: 4 samples a pixel, textures with mip levels. Opaque and masked meshes first,
/// then the blended ones by the distance of their centres, far to near. Errors: device_failed.
Result<Image> render(const Device& device, std::span<const RenderMesh> meshes, const Camera& camera,
                     const RenderOptions& options = {});

}  // namespace applique
