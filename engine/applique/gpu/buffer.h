#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "applique/gpu/device.h"
#include "applique/gpu/device_object.h"

namespace applique {

/// Memory of a device, read and written from outside through copies: directly where the processor sees the
/// memory, else by way of a staging buffer.
class Buffer {
 public:
  Buffer() = default;
  /// `size` > 0 bytes. Errors: device_failed.
  static Result<Buffer> create(const Device& device, const std::string& name, VkDeviceSize size,
                               VkBufferUsageFlags usage);

  [[nodiscard]] VkBuffer handle() const { return buffer_.get(); }
  [[nodiscard]] VkDeviceSize size() const { return size_; }

  /// Copies from or to the start of the buffer; no more bytes than it has. Errors: device_failed.
  Result<void> write(const Device& device, std::span<const std::byte> bytes) const;
  Result<void> read(const Device& device, std::span<std::byte> bytes) const;

 private:
  static Result<Buffer> create_in(const Device& device, const std::string& name, VkDeviceSize size,
                                  VkBufferUsageFlags usage, VkMemoryPropertyFlags required,
                                  VkMemoryPropertyFlags preferred);

  DeviceObject<VkDeviceMemory> memory_;
  DeviceObject<VkBuffer> buffer_;
  VkDeviceSize size_ = 0;
  std::byte* mapped_ = nullptr;  // Null where the processor does not see the memory.
  bool cached_ = false;          // Reading through `mapped_` is fast.
};

/// A buffer with the contents of `items`, at least one byte long.
template <class Items>
Result<Buffer> make_buffer(const Device& device, const std::string& name, const Items& items,
                           VkBufferUsageFlags usage) {
  const auto bytes = std::as_bytes(std::span(items));
  APPLIQUE_TRY(Buffer buffer, Buffer::create(device, name, bytes.empty() ? 16 : bytes.size(), usage));
  APPLIQUE_CHECK(buffer.write(device, bytes));
  return buffer;
}

}  // namespace applique
