#include "applique/gpu/compute_pipeline.h"

#include <algorithm>

namespace applique {

Result<ComputePipeline> ComputePipeline::create(const Device& device, const ComputePipelineInfo& info) {
  const VkDevice handle = device.handles().device;
  ComputePipeline result;
  result.device_ = &device;
  result.uniform_ = info.uniform;

  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const std::uint32_t binding : info.storage) {
    bindings.push_back({binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  }
  for (const std::uint32_t binding : info.uniform) {
    bindings.push_back({binding, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  }
  VkDescriptorSetLayoutCreateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_info.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set_info.pBindings = bindings.data();
  APPLIQUE_VK_CREATE(device, result.set_layout_, vkCreateDescriptorSetLayout, vkDestroyDescriptorSetLayout,
                     &set_info);

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, info.push_size};
  VkPipelineLayoutCreateInfo layout_info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = result.set_layout_.address();
  layout_info.pushConstantRangeCount = info.push_size > 0 ? 1 : 0;
  layout_info.pPushConstantRanges = &push;
  APPLIQUE_VK_CREATE(device, result.layout_, vkCreatePipelineLayout, vkDestroyPipelineLayout, &layout_info);

  std::vector<VkDescriptorPoolSize> sizes;
  if (!info.storage.empty()) {
    sizes.push_back({VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, static_cast<std::uint32_t>(info.storage.size())});
  }
  if (!info.uniform.empty()) {
    sizes.push_back({VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, static_cast<std::uint32_t>(info.uniform.size())});
  }
  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool_info.pPoolSizes = sizes.data();
  APPLIQUE_VK_CREATE(device, result.pool_, vkCreateDescriptorPool, vkDestroyDescriptorPool, &pool_info);
  VkDescriptorSetAllocateInfo set_allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  set_allocate.descriptorPool = result.pool_.get();
  set_allocate.descriptorSetCount = 1;
  set_allocate.pSetLayouts = result.set_layout_.address();
  APPLIQUE_VK(device, vkAllocateDescriptorSets, handle, &set_allocate, &result.set_);

  VkShaderModuleCreateInfo module_info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  module_info.codeSize = info.spirv.size_bytes();
  module_info.pCode = info.spirv.data();
  DeviceObject<VkShaderModule> module;
  APPLIQUE_VK_CREATE(device, module, vkCreateShaderModule, vkDestroyShaderModule, &module_info);
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t k = 0; k < info.constants.size(); ++k)
    entries.push_back({k, k * std::uint32_t{sizeof(std::uint32_t)}, sizeof(std::uint32_t)});
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            info.constants.size() * sizeof(std::uint32_t),
                                            info.constants.data()};
  VkComputePipelineCreateInfo pipeline_info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  pipeline_info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                         nullptr,
                         0,
                         VK_SHADER_STAGE_COMPUTE_BIT,
                         module.get(),
                         "main",
                         &specialization};
  pipeline_info.layout = result.layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  APPLIQUE_VK(device, vkCreateComputePipelines, handle, device.pipeline_cache(), 1, &pipeline_info, nullptr,
              &pipeline);
  result.pipeline_ = {handle, pipeline, device.functions().vkDestroyPipeline};
  device.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), info.name);
  device.set_name(VK_OBJECT_TYPE_DESCRIPTOR_SET, reinterpret_cast<std::uint64_t>(result.set_), info.name);
  return result;
}

void ComputePipeline::bind(const std::vector<Binding>& bindings) const {
  std::vector<VkDescriptorBufferInfo> buffers(bindings.size());
  std::vector<VkWriteDescriptorSet> writes(bindings.size());
  for (std::size_t i = 0; i < bindings.size(); ++i) {
    const bool uniform = std::find(uniform_.begin(), uniform_.end(), bindings[i].binding) != uniform_.end();
    buffers[i] = {bindings[i].buffer->handle(), 0, VK_WHOLE_SIZE};
    writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[i].dstSet = set_;
    writes[i].dstBinding = bindings[i].binding;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType =
        uniform ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[i].pBufferInfo = &buffers[i];
  }
  device_->functions().vkUpdateDescriptorSets(
      device_->handles().device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

void ComputePipeline::dispatch(VkCommandBuffer commands, std::span<const std::byte> push,
                               std::uint32_t groups) const {
  const VolkDeviceTable& vk = device_->functions();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set_, 0,
                             nullptr);
  if (!push.empty()) {
    vk.vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                          static_cast<std::uint32_t>(push.size()), push.data());
  }
  vk.vkCmdDispatch(commands, groups, 1, 1);
}

}  // namespace applique
