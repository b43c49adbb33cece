#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "document.h"

namespace applique {

/// Appends bytes to the document's chunk, on a multiple of 4, and a buffer view of them; returns its index. A
/// document without a chunk gets one, as a new buffer. `target` is 34962 for vertices, 34963 for indices.
std::size_t add_buffer_view(Document& document, std::span<const std::uint8_t> bytes,
                            std::optional<int> target = {});

/// Gives a buffer view new bytes, at the end of the chunk. The old bytes are taken out of the chunk where
/// that is safe (they are in the chunk, no other view overlaps them, and only buffer views refer to buffers).
void replace_buffer_view(Document& document, std::size_t view, std::span<const std::uint8_t> bytes);

/// Takes out a buffer view that nothing refers to any more, and its bytes where that is safe.
void remove_buffer_view(Document& document, std::size_t view);

/// How many members "bufferView" of the document name the view.
std::size_t count_view_uses(const Document& document, std::size_t view);

/// Appends packed elements of an accessor and the accessor itself; returns its index. `values` holds
/// `components` numbers an element, as they are stored; `entry` has the accessor's componentType and type,
/// and what else it is to keep. Rows of vertex attributes are padded to multiples of 4 bytes.
std::size_t add_accessor(Document& document, Document::Json entry, std::span<const double> values,
                         int components, bool bounds, int target);

/// Takes out those of the accessors that nothing refers to any more, with the buffer views that only they
/// used. None is taken out of a document with extensions whose references are not known here.
void remove_unused_accessors(Document& document, std::vector<std::size_t> accessors);

}  // namespace applique
