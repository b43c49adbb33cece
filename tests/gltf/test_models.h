#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

/// The third-party test data, "" when there is none.
inline std::filesystem::path test_data() {
  return APPLIQUE_TEST_DATA;
}

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
