#pragma once

#include <string>

#include "applique/gpu/device.h"
#include "applique/gpu/device_object.h"

namespace applique {

struct GpuImageInfo {
  std::string name;
  std::uint32_t width = 1;   ///< Pixels.
  std::uint32_t height = 1;  ///< Pixels.
  VkFormat format = VK_FORMAT_R8G8B8A8_SRGB;
  VkImageUsageFlags usage = 0;
  VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
  std::uint32_t levels = 1;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

/// A 2-D image in a device's memory, with its memory and a view of all its levels.
class GpuImage {
 public:
  GpuImage() = default;
  /// Errors: device_failed.
  static Result<GpuImage> create(const Device& device, const GpuImageInfo& info);

  [[nodiscard]] VkImage handle() const { return image_.get(); }
  [[nodiscard]] VkImageView view() const { return view_.get(); }
  [[nodiscard]] const GpuImageInfo& info() const { return info_; }

 private:
  GpuImageInfo info_;
  DeviceObject<VkDeviceMemory> memory_;
  DeviceObject<VkImage> image_;
  DeviceObject<VkImageView> view_;
};

/// What a barrier waits for and what waits for it.
struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags stage;
  VkAccessFlags access;
};

/// Records the change of levels [first, first + count) from one use to another.
void transition(const Device& device, VkCommandBuffer commands, const GpuImage& image, std::uint32_t first,
                std::uint32_t count, const ImageUse& from, const ImageUse& to);

/// Records the filling of all levels from the finest, each the box-filtered half of the one before. All
/// levels are transfer destinations at first and are read by fragment shaders at the end.
void fill_levels(const Device& device, VkCommandBuffer commands, const GpuImage& image);

}  // namespace applique
