#include "applique/gpu/graphics_pipeline.h"

#include <array>
#include <cstddef>

namespace applique {
namespace {

Result<DeviceObject<VkShaderModule>> make_module(const Device& device, std::span<const std::uint32_t> spirv) {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = spirv.size_bytes();
  info.pCode = spirv.data();
  DeviceObject<VkShaderModule> module;
  APPLIQUE_VK_CREATE(device, module, vkCreateShaderModule, vkDestroyShaderModule, &info);
  return module;
}

}  // namespace

Result<DeviceObject<VkPipeline>> make_graphics_pipeline(const Device& device,
                                                        const GraphicsPipelineInfo& info,
                                                        VkPipelineLayout layout, VkRenderPass pass,
                                                        VkExtent2D size, VkSampleCountFlagBits samples) {
  APPLIQUE_TRY(const DeviceObject<VkShaderModule> vertex, make_module(device, info.vertex));
  APPLIQUE_TRY(const DeviceObject<VkShaderModule> fragment, make_module(device, info.fragment));
  std::array<VkPipelineShaderStageCreateInfo, 2> stages{};
  for (VkPipelineShaderStageCreateInfo& stage : stages) {
    stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stage.pName = "main";
  }
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = vertex.get();
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = fragment.get();

  const VkVertexInputBindingDescription binding{0, sizeof(RenderVertex), VK_VERTEX_INPUT_RATE_VERTEX};
  const std::array<VkVertexInputAttributeDescription, 3> attributes = {{
      {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(RenderVertex, position)},
      {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(RenderVertex, normal)},
      {2, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(RenderVertex, uv)},
  }};
  VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  if (!info.backdrop) {
    input.vertexBindingDescriptionCount = 1;
    input.pVertexBindingDescriptions = &binding;
    input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(attributes.size());
    input.pVertexAttributeDescriptions = attributes.data();
  }
  VkPipelineInputAssemblyStateCreateInfo assembly{
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;

  const VkViewport viewport{0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1};
  const VkRect2D scissor{{0, 0}, size};
  VkPipelineViewportStateCreateInfo view{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  view.viewportCount = 1;
  view.pViewports = &viewport;
  view.scissorCount = 1;
  view.pScissors = &scissor;

  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = info.double_sided || info.backdrop ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  // A blended mesh may lie exactly on another, as an overlay does.
  raster.depthBiasEnable = info.blend ? VK_TRUE : VK_FALSE;
  raster.depthBiasConstantFactor = -4;
  raster.depthBiasSlopeFactor = -1;

  VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  multisample.rasterizationSamples = samples;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = info.backdrop ? VK_FALSE : VK_TRUE;
  depth.depthWriteEnable = info.backdrop || info.blend ? VK_FALSE : VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;

  VkPipelineColorBlendAttachmentState target{};
  target.blendEnable = info.blend ? VK_TRUE : VK_FALSE;
  target.srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
  target.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  target.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  target.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  target.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                          VK_COLOR_COMPONENT_A_BIT;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &target;

  VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  create.stageCount = static_cast<std::uint32_t>(stages.size());
  create.pStages = stages.data();
  create.pVertexInputState = &input;
  create.pInputAssemblyState = &assembly;
  create.pViewportState = &view;
  create.pRasterizationState = &raster;
  create.pMultisampleState = &multisample;
  create.pDepthStencilState = &depth;
  create.pColorBlendState = &blend;
  create.layout = layout;
  create.renderPass = pass;
  const VkDevice handle = device.handles().device;
  VkPipeline pipeline = VK_NULL_HANDLE;
  APPLIQUE_VK(device, vkCreateGraphicsPipelines, handle, device.pipeline_cache(), 1, &create, nullptr,
              &pipeline);
  device.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), info.name);
  return DeviceObject<VkPipeline>(handle, pipeline, device.functions().vkDestroyPipeline);
}

}  // namespace applique
