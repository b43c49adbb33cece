#include "applique/gpu/compute_pipeline.h"

#include <algorithm>
#include <utility>

namespace applique {

Result<ComputePipeline> ComputePipeline::create(const Device& device, const ComputePipelineInfo& info) {
  const VkDevice handle = device.handles().device;
  const VolkDeviceTable& vk = device.functions();
  ComputePipeline result;
  result.functions_ = &vk;
  result.device_ = handle;
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
  APPLIQUE_VK(device, vkCreateDescriptorSetLayout, handle, &set_info, nullptr, &result.set_layout_);

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, info.push_size};
  VkPipelineLayoutCreateInfo layout_info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &result.set_layout_;
  layout_info.pushConstantRangeCount = info.push_size > 0 ? 1 : 0;
  layout_info.pPushConstantRanges = &push;
  APPLIQUE_VK(device, vkCreatePipelineLayout, handle, &layout_info, nullptr, &result.layout_);

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
  APPLIQUE_VK(device, vkCreateDescriptorPool, handle, &pool_info, nullptr, &result.pool_);
  VkDescriptorSetAllocateInfo set_allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  set_allocate.descriptorPool = result.pool_;
  set_allocate.descriptorSetCount = 1;
  set_allocate.pSetLayouts = &result.set_layout_;
  APPLIQUE_VK(device, vkAllocateDescriptorSets, handle, &set_allocate, &result.set_);

  VkShaderModuleCreateInfo module_info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  module_info.codeSize = info.spirv.size_bytes();
  module_info.pCode = info.spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  APPLIQUE_VK(device, vkCreateShaderModule, handle, &module_info, nullptr, &module);
  const VkBool32 constant = info.constant ? VK_TRUE : VK_FALSE;
  const VkSpecializationMapEntry entry{0, 0, sizeof(constant)};
  const VkSpecializationInfo specialization{1, &entry, sizeof(constant), &constant};
  VkComputePipelineCreateInfo pipeline_info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  pipeline_info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                         nullptr,
                         0,
                         VK_SHADER_STAGE_COMPUTE_BIT,
                         module,
                         "main",
                         &specialization};
  pipeline_info.layout = result.layout_;
  const VkResult made = vk.vkCreateComputePipelines(handle, device.pipeline_cache(), 1, &pipeline_info,
                                                    nullptr, &result.pipeline_);
  vk.vkDestroyShaderModule(handle, module, nullptr);
  if (made != VK_SUCCESS) return device_failure("vkCreateComputePipelines", made);
  device.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(result.pipeline_), info.name);
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
  functions_->vkUpdateDescriptorSets(device_, static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                                     nullptr);
}

void ComputePipeline::dispatch(VkCommandBuffer commands, std::span<const std::byte> push,
                               std::uint32_t groups) const {
  functions_->vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
  functions_->vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0,
                                      nullptr);
  if (!push.empty()) {
    functions_->vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                   static_cast<std::uint32_t>(push.size()), push.data());
  }
  functions_->vkCmdDispatch(commands, groups, 1, 1);
}

void ComputePipeline::destroy() {
  if (functions_ == nullptr) return;
  functions_->vkDestroyPipeline(device_, pipeline_, nullptr);
  functions_->vkDestroyDescriptorPool(device_, pool_, nullptr);
  functions_->vkDestroyPipelineLayout(device_, layout_, nullptr);
  functions_->vkDestroyDescriptorSetLayout(device_, set_layout_, nullptr);
  functions_ = nullptr;
}

ComputePipeline::~ComputePipeline() {
  destroy();
}

ComputePipeline::ComputePipeline(ComputePipeline&& other) noexcept {
  *this = std::move(other);
}

ComputePipeline& ComputePipeline::operator=(ComputePipeline&& other) noexcept {
  std::swap(functions_, other.functions_);
  std::swap(device_, other.device_);
  std::swap(set_layout_, other.set_layout_);
  std::swap(layout_, other.layout_);
  std::swap(pipeline_, other.pipeline_);
  std::swap(pool_, other.pool_);
  std::swap(set_, other.set_);
  std::swap(uniform_, other.uniform_);
  return *this;
}

}  // namespace applique
