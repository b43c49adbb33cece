#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "applique/image/image.h"

#include "document.h"

namespace applique {

/// The third-party test data, "" when there is none.
inline std::filesystem::path test_data() {
  return APPLIQUE_TEST_DATA;
}

inline constexpr const char* no_test_data =
    "the third-party test data are not there (set APPLIQUE_TEST_DATA)";

/// All .glb and .gltf files below a folder of the test data, sorted.
inline std::vector<std::filesystem::path> models_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  if (!std::filesystem::exists(folder)) return paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".glb" || extension == ".gltf") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// The models that are meant to load.
inline std::vector<std::filesystem::path> good_models() {
  auto paths = models_below(test_data() / "gltf");
  const auto derived = models_below(test_data() / "derived" / "gltf");
  paths.insert(paths.end(), derived.begin(), derived.end());
  return paths;
}

/// A folder that goes with the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "applique_test_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A GLB of a JSON text and a chunk, both padded.
inline std::vector<std::uint8_t> make_glb(std::string json, std::vector<std::uint8_t> chunk = {}) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  chunk.resize((chunk.size() + 3) / 4 * 4);
  std::vector<std::uint8_t> glb;
  const auto put = [&](std::size_t word) {
    for (int shift = 0; shift < 32; shift += 8) glb.push_back(static_cast<std::uint8_t>(word >> shift));
  };
  put(0x46546C67);
  put(2);
  put(12 + 8 + json.size() + (chunk.empty() ? 0 : 8 + chunk.size()));
  put(json.size());
  put(0x4E4F534A);
  glb.insert(glb.end(), json.begin(), json.end());
  if (!chunk.empty()) {
    put(chunk.size());
    put(0x004E4942);
    glb.insert(glb.end(), chunk.begin(), chunk.end());
  }
  return glb;
}

/// PNG bytes of one colour.
inline std::vector<std::uint8_t> make_png(int size, std::array<std::uint16_t, 4> colour) {
  return encode_png(make_image(size, size, colour)).value();
}

}  // namespace applique
