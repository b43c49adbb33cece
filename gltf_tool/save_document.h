#pragma once

#include <filesystem>
#include <vector>

#include "document.h"

namespace applique {

/// Writes a document as .glb or .gltf, by the path's extension.
/// - A GLB stays as it is when written as a GLB; a .gltf is packed: its buffers become the BIN chunk and its
/// image
///   files buffer views. What cannot be read (a missing image) keeps its URI.
/// - Written as .gltf, the chunk becomes NAME.bin, and new images and those in the chunk NAME_….png (.jpg,
///   .webp); other files are copied beside the output under their own relative URIs (only the name of those
///   that point out of their folder). None of them takes the place of another or of a file in `keep`.
/// Every file is written under a temporary name and renamed, the main file last. Errors: output_unwritable,
/// naming the path and the reason; file_unreadable for a buffer to copy that cannot be read.
Result<void> save_document(const Document& document, const std::filesystem::path& path,
                           const std::vector<std::filesystem::path>& keep = {});

}  // namespace applique
