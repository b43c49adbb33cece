#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <volk.h>

#include "applique/base/error.h"

namespace applique {

/// Whether the environment asks for the validation layers: APPLIQUE_VALIDATION=1.
bool validation_wanted();

struct DeviceRequest {
  /// An index in the loader's order ("0"), or a part of a device's name in any case ("llvmpipe"), or empty
  /// for the best one present: discrete before integrated before virtual before software.
  std::string selector;
  bool validation = validation_wanted();  ///< Turns on VK_LAYER_KHRONOS_validation where it is installed.
};

/// A Vulkan device in use: what it was created from stays with whoever created it.
struct DeviceHandles {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
};

/// A Vulkan 1.1 device with one queue for graphics and compute. What is made with it points at it: it must
/// neither move nor go while that is in use. Pipelines are cached between runs under $XDG_CACHE_HOME/applique
/// or
/// ~/.cache/applique. Not thread-safe.
class Device {
 public:
  /// Errors: no_device (there is no loader, or no device fits: the message lists why each was turned down).
  static Result<Device> create(const DeviceRequest& request = {});
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] const VkPhysicalDeviceProperties& properties() const;
  [[nodiscard]] const VkPhysicalDeviceMemoryProperties& memory() const;
  [[nodiscard]] const DeviceHandles& handles() const;
  [[nodiscard]] const VolkDeviceTable& functions() const;
  [[nodiscard]] VkPipelineCache pipeline_cache() const;

  /// What the validation layers said so far: warnings and errors.
  [[nodiscard]] std::vector<std::string> validation_messages() const;

  /// Records commands, submits them and waits until they are done. Errors: device_failed.
  Result<void> run(const std::function<void(VkCommandBuffer)>& record) const;

  /// Names an object in validation messages and debuggers.
  void set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

 private:
  struct State;
  explicit Device(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// device_failed with the failing call and Vulkan's name for the result; memory errors say what to do.
tl::unexpected<Error> device_failure(const char* call, VkResult result);

/// Index of a memory type among `allowed` (a bit mask) with all `required` and, if there is one, all
/// `preferred` properties. Errors: device_failed.
Result<std::uint32_t> find_memory_type(const Device& device, std::uint32_t allowed,
                                       VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred);

/// Returns device_failed from the enclosing function if a Vulkan call does not succeed.
#define APPLIQUE_VK(device, function, ...)                                                                  \
  do {                                                                                                      \
    if (const VkResult applique_vk = (device).functions().function(__VA_ARGS__); applique_vk != VK_SUCCESS) \
      return ::applique::device_failure(#function, applique_vk);                                            \
  } while (false)

}  // namespace applique
