#include "applique/gpu/device.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "applique/gpu/buffer.h"
#include "applique/gpu/pipeline_cache.h"

#include "gpu/gpu_fixture.h"

namespace applique {
namespace {

using DeviceTest = GpuTest;

TEST_F(DeviceTest, IsPickedByIndexOrPartOfItsName) {
  const auto by_index = Device::create({"0", false});
  ASSERT_TRUE(by_index) << by_index.error().message;
  std::string part = by_index->name().substr(1, 5);
  for (char& c : part) c = static_cast<char>(std::toupper(c));
  const auto by_name = Device::create({part, false});
  ASSERT_TRUE(by_name) << by_name.error().message;
}

TEST_F(DeviceTest, SaysWhyNoDeviceFits) {
  const auto result = Device::create({"no such device", false});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::no_device);
  EXPECT_NE(result.error().message.find("no Vulkan device is 'no such device'"), std::string::npos);
  EXPECT_NE(result.error().message.find("'" + device().name() + "': it is not the one asked for"),
            std::string::npos)
      << result.error().message;
  EXPECT_FALSE(Device::create({"99", false}));
}

TEST_F(DeviceTest, CollectsValidationMessages) {
  // Without this, silence in the other tests would mean nothing.
  const Device validated = Device::create({"", true}).value();
  EXPECT_TRUE(validated.validation_messages().empty());
  const VkDevice handle = validated.handles().device;
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = 16;
  info.usage = 0;  // Must not be.
  VkBuffer buffer = VK_NULL_HANDLE;
  validated.functions().vkCreateBuffer(handle, &info, nullptr, &buffer);
  validated.functions().vkDestroyBuffer(handle, buffer, nullptr);
  EXPECT_FALSE(validated.validation_messages().empty());
}

TEST_F(DeviceTest, BuffersKeepWhatIsWritten) {
  std::vector<std::uint32_t> numbers(10000), back(10000);
  std::iota(numbers.begin(), numbers.end(), 7U);
  Buffer buffer = make_buffer(device(), "numbers", numbers, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT).value();
  const Buffer moved = std::move(buffer);
  ASSERT_TRUE(moved.read(device(), std::as_writable_bytes(std::span(back))));
  EXPECT_EQ(numbers, back);
}

class PipelineCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    // Of its own: the tests run side by side.
    folder_ =
        std::filesystem::path(testing::TempDir()) / ("applique_pipeline_cache_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    if (const char* set = std::getenv("XDG_CACHE_HOME")) before_ = set;
    setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
    properties_.vendorID = 5;
    properties_.deviceID = 6;
    std::memset(properties_.pipelineCacheUUID, 0xab, VK_UUID_SIZE);
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    if (before_.empty()) {
      unsetenv("XDG_CACHE_HOME");
    } else {
      setenv("XDG_CACHE_HOME", before_.c_str(), 1);
    }
  }
  [[nodiscard]] std::vector<std::uint8_t> stored() const {
    VkPipelineCacheHeaderVersionOne header{};
    header.headerSize = sizeof(header);
    header.headerVersion = VK_PIPELINE_CACHE_HEADER_VERSION_ONE;
    header.vendorID = properties_.vendorID;
    header.deviceID = properties_.deviceID;
    std::memcpy(header.pipelineCacheUUID, properties_.pipelineCacheUUID, VK_UUID_SIZE);
    std::vector<std::uint8_t> bytes(sizeof(header) + 5, 1);
    std::memcpy(bytes.data(), &header, sizeof(header));
    return bytes;
  }

  std::filesystem::path folder_;
  std::string before_;
  VkPhysicalDeviceProperties properties_{};
};

TEST_F(PipelineCacheTest, ComesBackOnTheSameDeviceOnly) {
  const auto path = pipeline_cache_path(properties_);
  EXPECT_EQ(path.parent_path(), folder_ / "applique");
  EXPECT_TRUE(read_pipeline_cache(path, properties_).empty());
  write_pipeline_cache(path, stored());
  EXPECT_EQ(read_pipeline_cache(path, properties_), stored());
  VkPhysicalDeviceProperties other = properties_;
  other.pipelineCacheUUID[3] ^= 1;
  EXPECT_TRUE(read_pipeline_cache(path, other).empty());
  // Nothing but the cache is left behind.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path.parent_path()), {}), 1);
}

TEST_F(PipelineCacheTest, IgnoresWhatIsCutShort) {
  const auto path = pipeline_cache_path(properties_);
  for (std::size_t length = 0; length < sizeof(VkPipelineCacheHeaderVersionOne); ++length) {
    auto bytes = stored();
    bytes.resize(length);
    write_pipeline_cache(path, bytes);
    EXPECT_TRUE(read_pipeline_cache(path, properties_).empty()) << length;
  }
}

TEST_F(PipelineCacheTest, IsLeftOutWhereItCannotBeWritten) {
  std::ofstream(folder_) << "a file, not a folder";
  const auto path = pipeline_cache_path(properties_);
  write_pipeline_cache(path, stored());
  EXPECT_TRUE(read_pipeline_cache(path, properties_).empty());
}

}  // namespace
}  // namespace applique
