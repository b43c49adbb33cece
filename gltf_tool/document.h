#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "applique/base/error.h"

namespace applique {

/// A glTF file as it stands: its JSON in its own order, and its binary chunk. Edits touch only what they are for,
/// so that everything else (extras, unknown extensions, buffers, images) is written as it was read. tinygltf, which
/// decodes geometry, would drop what it does not know when writing.
struct Document {
  nlohmann::ordered_json json;
  std::vector<std::uint8_t> binary_chunk;  ///< The GLB's BIN chunk; empty for a .gltf.
  std::filesystem::path folder;            ///< Where relative URIs start.
  bool is_glb = true;
};

}  // namespace applique
