#pragma once

#include <span>
#include <string>
#include <vector>

#include "applique/gpu/buffer.h"
#include "applique/gpu/device.h"

namespace applique {

struct ComputePipelineInfo {
  std::string name;
  std::span<const std::uint32_t> spirv;
  std::vector<std::uint32_t> storage;    ///< Bindings of storage buffers, in set 0; every device has 4.
  std::vector<std::uint32_t> uniform;    ///< Bindings of uniform buffers, in set 0.
  std::uint32_t push_size = 0;           ///< Bytes.
  std::vector<std::uint32_t> constants;  ///< Specialisation constants 0, 1, …
};

/// A compute shader with its one descriptor set.
class ComputePipeline {
 public:
  ComputePipeline() = default;
  static Result<ComputePipeline> create(const Device& device, const ComputePipelineInfo& info);

  struct Binding {
    std::uint32_t binding;
    const Buffer* buffer;
  };
  /// Sets the buffers of the coming dispatches; while none of the pipeline's commands are under way.
  void bind(const std::vector<Binding>& bindings) const;
  /// Records one dispatch of `groups` workgroups along x.
  void dispatch(VkCommandBuffer commands, std::span<const std::byte> push, std::uint32_t groups) const;

 private:
  const Device* device_ = nullptr;
  DeviceObject<VkDescriptorSetLayout> set_layout_;
  DeviceObject<VkPipelineLayout> layout_;
  DeviceObject<VkPipeline> pipeline_;
  DeviceObject<VkDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::vector<std::uint32_t> uniform_;
};

}  // namespace applique
