#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "applique/gpu/device.h"
#include "applique/gpu/device_object.h"

namespace applique {

/// A mesh's vertex as the preview's shaders read it.
struct RenderVertex {
  float position[3];
  float normal[3];
  float uv[2];
};

/// What the preview's pipelines differ in.
struct GraphicsPipelineInfo {
  std::string name;
  std::span<const std::uint32_t> vertex;
  std::span<const std::uint32_t> fragment;
  bool backdrop = false;  ///< No vertices, behind everything.
  bool blend = false;  ///< Premultiplied over; tests the depth, drawn a little nearer, but does not write it.
  bool double_sided = false;  ///< Back faces are drawn too.
};

/// Builds a pipeline for subpass 0 of `pass`, for a picture of the given size. Errors: device_failed.
Result<DeviceObject<VkPipeline>> make_graphics_pipeline(const Device& device,
                                                        const GraphicsPipelineInfo& info,
                                                        VkPipelineLayout layout, VkRenderPass pass,
                                                        VkExtent2D size, VkSampleCountFlagBits samples);

}  // namespace applique
