#pragma once

#include <type_traits>
#include <utility>

#include <volk.h>

namespace applique {

/// Owns one Vulkan object of a device and destroys it: `DeviceObject<VkBuffer>`.
template <class Handle>
class DeviceObject {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*);

  DeviceObject() = default;
  DeviceObject(VkDevice device, Handle handle, Destroy destroy)
      : device_(device), handle_(handle), destroy_(destroy) {}
  ~DeviceObject() {
    if (handle_ != VK_NULL_HANDLE) destroy_(device_, handle_, nullptr);
  }
  DeviceObject(DeviceObject&& other) noexcept { *this = std::move(other); }
  DeviceObject& operator=(DeviceObject&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    std::swap(destroy_, other.destroy_);
    return *this;
  }

  [[nodiscard]] Handle get() const { return handle_; }
  [[nodiscard]] const Handle* address() const { return &handle_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
};

}  // namespace applique

/// Sets `owner`, a DeviceObject, to what `create` (vkCreate… or vkAllocateMemory) makes; `destroy` is its
/// counterpart. Returns device_failed from the enclosing function on failure.
#define APPLIQUE_VK_CREATE(device, owner, create, destroy, info)                                  \
  do {                                                                                            \
    std::remove_const_t<std::remove_pointer_t<decltype((owner).address())>> applique_handle =     \
        VK_NULL_HANDLE;                                                                           \
    APPLIQUE_VK(device, create, (device).handles().device, info, nullptr, &applique_handle);      \
    (owner) = DeviceObject<decltype(applique_handle)>((device).handles().device, applique_handle, \
                                                      (device).functions().destroy);              \
  } while (false)
