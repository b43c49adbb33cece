#include "applique/gpu/gpu_image.h"

#include <algorithm>

namespace applique {
namespace {

constexpr ImageUse written_by_copy = {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                      VK_ACCESS_TRANSFER_WRITE_BIT};
constexpr ImageUse read_by_copy = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                   VK_ACCESS_TRANSFER_READ_BIT};
constexpr ImageUse sampled = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                              VK_ACCESS_SHADER_READ_BIT};

}  // namespace

Result<GpuImage> GpuImage::create(const Device& device, const GpuImageInfo& info) {
  GpuImage result;
  result.info_ = info;
  VkImageCreateInfo image{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  image.imageType = VK_IMAGE_TYPE_2D;
  image.format = info.format;
  image.extent = {info.width, info.height, 1};
  image.mipLevels = info.levels;
  image.arrayLayers = 1;
  image.samples = info.samples;
  image.usage = info.usage;
  APPLIQUE_VK_CREATE(device, result.image_, vkCreateImage, vkDestroyImage, &image);
  VkMemoryRequirements needs;
  device.functions().vkGetImageMemoryRequirements(device.handles().device, result.handle(), &needs);
  APPLIQUE_TRY(const std::uint32_t type,
               find_memory_type(device, needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT));
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  APPLIQUE_VK_CREATE(device, result.memory_, vkAllocateMemory, vkFreeMemory, &allocate);
  APPLIQUE_VK(device, vkBindImageMemory, device.handles().device, result.handle(), result.memory_.get(), 0);
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = result.handle();
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = info.format;
  view.subresourceRange = {info.aspect, 0, info.levels, 0, 1};
  APPLIQUE_VK_CREATE(device, result.view_, vkCreateImageView, vkDestroyImageView, &view);
  device.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(result.handle()), info.name);
  return result;
}

void transition(const Device& device, VkCommandBuffer commands, const GpuImage& image, std::uint32_t first,
                std::uint32_t count, const ImageUse& from, const ImageUse& to) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = from.access;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
  barrier.subresourceRange = {image.info().aspect, first, count, 0, 1};
  device.functions().vkCmdPipelineBarrier(commands, from.stage, to.stage, 0, 0, nullptr, 0, nullptr, 1,
                                          &barrier);
}

void fill_levels(const Device& device, VkCommandBuffer commands, const GpuImage& image) {
  const GpuImageInfo& info = image.info();
  const auto extent = [&](std::uint32_t level) {
    return VkOffset3D{static_cast<std::int32_t>(std::max(1u, info.width >> level)),
                      static_cast<std::int32_t>(std::max(1u, info.height >> level)), 1};
  };
  for (std::uint32_t level = 1; level < info.levels; ++level) {
    transition(device, commands, image, level - 1, 1, written_by_copy, read_by_copy);
    VkImageBlit blit{};
    blit.srcSubresource = {info.aspect, level - 1, 0, 1};
    blit.srcOffsets[1] = extent(level - 1);
    blit.dstSubresource = {info.aspect, level, 0, 1};
    blit.dstOffsets[1] = extent(level);
    device.functions().vkCmdBlitImage(commands, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                      image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                                      VK_FILTER_LINEAR);
  }
  if (info.levels > 1) transition(device, commands, image, 0, info.levels - 1, read_by_copy, sampled);
  transition(device, commands, image, info.levels - 1, 1, written_by_copy, sampled);
}

}  // namespace applique
