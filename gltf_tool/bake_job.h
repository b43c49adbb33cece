#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "applique/gpu/device.h"
#include "applique/gpu/gpu_transfer.h"

#include "document.h"
#include "report.h"
#include "solve_job.h"
#include "texture_encoding.h"

namespace applique {

/// A device with its transfer pipelines: made while the geometry is solved.
struct GpuBaker {
  Device device;
  std::optional<GpuTransfer> transfer;  ///< Always there after create_baker.
};

/// Errors: device_failed.
Result<std::unique_ptr<GpuBaker>> create_baker(Device device);

/// A model with its decals, not yet saved, and what the report says about it.
struct BakedJob {  // NOLINT(bugprone-exception-escape): so is Document
  Document document;
  std::vector<TextureReport> textures;
  std::vector<std::optional<TexelDensity>> densities;       ///< By decal; none for overlays.
  std::vector<std::vector<UvConflictReport>> uv_conflicts;  ///< By decal.
  std::vector<Warning> warnings;                            ///< Of the textures: texture_is_png.
  StageTimes times;
};

/// Puts the decals on the model: bakes the layers of each into the textures under it, or adds it as an
/// overlay. Triangles that are to get texture space of their own get it first: `job` then has the model with
/// them. Adds warnings to the decals: uv_overlap, low_texel_density, overlay_static, overlay_follows_nearly,
/// and those of warn_of_materials, DecalLayers and make_overlay_layers; and texture_is_png to the job.
/// Errors: uvs_missing, uvs_shared, device_failed, and those of load_model_image, DecalLayers and
/// encode_texture.
Result<BakedJob> bake_job(SolvedJob& job, GpuBaker& baker, const StageCallback& on_stage = {},
                          const TextureEncoding& encoding = {});

}  // namespace applique
