#include "applique/gpu/buffer.h"

#include <cstring>

namespace applique {
namespace {

constexpr VkMemoryPropertyFlags visible =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

Result<void> copy(const Device& device, VkBuffer from, VkBuffer to, VkDeviceSize size) {
  return device.run([&](VkCommandBuffer commands) {
    const VkBufferCopy region{0, 0, size};
    device.functions().vkCmdCopyBuffer(commands, from, to, 1, &region);
    VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    device.functions().vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                            VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0,
                                            nullptr);
  });
}

}  // namespace

Result<Buffer> Buffer::create(const Device& device, const std::string& name, VkDeviceSize size,
                              VkBufferUsageFlags usage) {
  return create_in(device, name, size,
                   usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                   VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, visible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
}

Result<Buffer> Buffer::create_in(const Device& device, const std::string& name, VkDeviceSize size,
                                 VkBufferUsageFlags usage, VkMemoryPropertyFlags required,
                                 VkMemoryPropertyFlags preferred) {
  const VkDevice handle = device.handles().device;
  Buffer buffer;
  buffer.size_ = size;
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = size;
  info.usage = usage;
  APPLIQUE_VK_CREATE(device, buffer.buffer_, vkCreateBuffer, vkDestroyBuffer, &info);
  VkMemoryRequirements needs;
  device.functions().vkGetBufferMemoryRequirements(handle, buffer.handle(), &needs);
  APPLIQUE_TRY(const std::uint32_t type, find_memory_type(device, needs.memoryTypeBits, required, preferred));
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  APPLIQUE_VK_CREATE(device, buffer.memory_, vkAllocateMemory, vkFreeMemory, &allocate);
  APPLIQUE_VK(device, vkBindBufferMemory, handle, buffer.handle(), buffer.memory_.get(), 0);
  const VkMemoryPropertyFlags properties = device.memory().memoryTypes[type].propertyFlags;
  if ((properties & visible) == visible) {
    void* mapped = nullptr;
    APPLIQUE_VK(device, vkMapMemory, handle, buffer.memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped);
    buffer.mapped_ = static_cast<std::byte*>(mapped);
    buffer.cached_ = (properties & VK_MEMORY_PROPERTY_HOST_CACHED_BIT) != 0;
  }
  device.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer.handle()), name);
  return buffer;
}

Result<void> Buffer::write(const Device& device, std::span<const std::byte> bytes) const {
  APPLIQUE_ASSERT(bytes.size() <= size_);
  if (bytes.empty()) return {};
  if (mapped_) {
    std::memcpy(mapped_, bytes.data(), bytes.size());
    return {};
  }
  APPLIQUE_TRY(const Buffer staging,
               create_in(device, "upload", bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, visible, 0));
  std::memcpy(staging.mapped_, bytes.data(), bytes.size());
  return copy(device, staging.handle(), handle(), bytes.size());
}

Result<void> Buffer::read(const Device& device, std::span<std::byte> bytes) const {
  APPLIQUE_ASSERT(bytes.size() <= size_);
  if (bytes.empty()) return {};
  if (mapped_ && cached_) {
    std::memcpy(bytes.data(), mapped_, bytes.size());
    return {};
  }
  APPLIQUE_TRY(const Buffer staging,
               create_in(device, "download", bytes.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, visible,
                         VK_MEMORY_PROPERTY_HOST_CACHED_BIT));
  APPLIQUE_CHECK(copy(device, handle(), staging.handle(), bytes.size()));
  std::memcpy(bytes.data(), staging.mapped_, bytes.size());
  return {};
}

}  // namespace applique
