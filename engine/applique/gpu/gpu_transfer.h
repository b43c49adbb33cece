#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "applique/gpu/compute_pipeline.h"
#include "applique/gpu/device.h"
#include "applique/transfer/transfer.h"

namespace applique {

struct GpuTransferOptions {
  int tile = 2048;  ///< Largest side of a piece of the texture that is worked on at once, texels, 8 to 16384.
  /// Largest buffer, bytes, at least 4096; 0 is what the device allows. A tile that needs more is cut, an
  /// image that does is gone through in pieces.
  std::uint64_t max_buffer_bytes = 0;
};

/// Transfers decals into textures with compute shaders: the fast twin of transfer_on_cpu, with the same
/// owners texel by texel, image points within 0.05 px (measured: 0.0005) and colours within 1/255. The device
/// must outlive it.
class GpuTransfer {
 public:
  /// Pipelines are compiled when they are first needed. Errors: device_failed.
  static Result<GpuTransfer> create(const Device& device, const GpuTransferOptions& options = {});

  /// As transfer_on_cpu. Only the texels around the faces go to the device and back. Errors: device_failed;
  /// the texture may then be partly done.
  Result<TransferResult> run(const Transfer& transfer, Image& texture, bool keep_samples = false);

 private:
  struct Run;
  /// How a texel finds its image point: by its linear face, by the warp, by a warp whose tables are large.
  enum class Shading { linear, warped, large_warp };

  /// `groups`: of the warp's features; the shader is compiled for each number of them.
  Result<const ComputePipeline*> shading_pipeline(Shading shading, std::uint32_t groups);
  Result<void> run_tile(Run& run, std::uint32_t sheet, const struct TexelRect& tile);

  const Device* device_ = nullptr;
  GpuTransferOptions options_;
  ComputePipeline cover_, nearest_;
  std::map<std::pair<Shading, std::uint32_t>, ComputePipeline> shade_;  // By Shading and groups.
};

}  // namespace applique
