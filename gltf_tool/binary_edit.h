#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "document.h"

namespace applique {

/// Appends bytes to the document's chunk, on a multiple of 4, and a buffer view of them; returns its index. A
/// document without a chunk gets one, as a new buffer. `target` is 34962 for vertices, 34963 for indices.
std::size_t add_buffer_view(Document& document, std::span<const std::uint8_t> bytes,
                            std::optional<int> target = {});

/// Gives a buffer view new bytes, at the end of the chunk. The old bytes are taken out of the chunk where
/// that is safe (they are in the chunk, no other view overlaps them, and only buffer views refer to buffers).
void replace_buffer_view(Document& document, std::size_t view, std::span<const std::uint8_t> bytes);

/// Takes a buffer view out of the list, as replace_buffer_view does its bytes. Nothing may refer to it any
/// more; other views are renumbered under every key "bufferView".
void remove_buffer_view(Document& document, std::size_t view);

}  // namespace applique
