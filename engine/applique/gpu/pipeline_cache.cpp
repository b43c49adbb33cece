#include "applique/gpu/pipeline_cache.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace applique {

std::filesystem::path pipeline_cache_path(const VkPhysicalDeviceProperties& device) {
  std::filesystem::path folder;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) {
    folder = cache;
  } else if (const char* home = std::getenv("HOME"); home && *home) {
    folder = std::filesystem::path(home) / ".cache";
  } else {
    return {};
  }
  std::string id;
  for (const std::uint8_t byte : device.pipelineCacheUUID) id += fmt::format("{:02x}", byte);
  return folder / "applique" /
         fmt::format("pipelines-{:x}-{:x}-{}.bin", device.vendorID, device.deviceID, id);
}

std::vector<std::uint8_t> read_pipeline_cache(const std::filesystem::path& path,
                                              const VkPhysicalDeviceProperties& device) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  VkPipelineCacheHeaderVersionOne header{};
  if (bytes.size() < sizeof(header)) return {};
  std::memcpy(&header, bytes.data(), sizeof(header));
  const bool matches = header.headerSize == sizeof(header) &&
                       header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
                       header.vendorID == device.vendorID && header.deviceID == device.deviceID &&
                       std::equal(std::begin(header.pipelineCacheUUID), std::end(header.pipelineCacheUUID),
                                  std::begin(device.pipelineCacheUUID));
  if (!matches) bytes.clear();
  return bytes;
}

void write_pipeline_cache(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  std::error_code failed;
  std::filesystem::create_directories(path.parent_path(), failed);
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}", ::getpid());
  {
    std::ofstream file(temporary, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) {
      file.close();
      std::filesystem::remove(temporary, failed);
      return;
    }
  }
  std::filesystem::rename(temporary, path, failed);
  if (failed) std::filesystem::remove(temporary, failed);
}

}  // namespace applique
