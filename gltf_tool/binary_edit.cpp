#include "binary_edit.h"

#include <algorithm>
#include <functional>

namespace applique {
namespace {

using Json = Document::Json;

/// Puts bytes at the end of the chunk and says where.
std::pair<std::size_t, std::size_t> append(Document& document, std::span<const std::uint8_t> bytes) {
  auto& buffers = document.json["buffers"];
  auto& chunk = document.binary_chunk;
  if (!document.chunk_buffer) {
    // A chunk that no buffer of a GLB refers to would be taken for the new buffer's bytes.
    chunk.clear();
    document.chunk_buffer = buffers.size();
    buffers.push_back({{"byteLength", 0}});
  }
  auto& buffer = buffers[*document.chunk_buffer];
  chunk.resize((buffer["byteLength"].get<std::size_t>() + 3) / 4 * 4);
  const std::size_t offset = chunk.size();
  chunk.insert(chunk.end(), bytes.begin(), bytes.end());
  buffer["byteLength"] = chunk.size();
  return {*document.chunk_buffer, offset};
}

/// Calls `function` with every range of a buffer that a view or its compression takes.
template <class Function>
void each_range(Json& json, Function function) {
  for (auto& view : json["bufferViews"]) {
    function(view);
    if (!view.contains("extensions") || !view["extensions"].is_object()) continue;
    for (auto& extension : view["extensions"])
      if (extension.is_object() && extension.contains("buffer") && extension.contains("byteLength"))
        function(extension);
  }
}

std::size_t count_buffer_keys(const Json& json) {
  std::size_t count = 0;
  if (json.is_object()) count += json.count("buffer");
  if (json.is_structured())
    for (const auto& member : json) count += count_buffer_keys(member);
  return count;
}

/// Takes bytes that nothing refers to out of the chunk, in multiples of 4 so that all alignments stay.
void erase_unused(Document& document, std::size_t begin, std::size_t end) {
  begin = (begin + 3) / 4 * 4;
  if (begin >= end) return;
  const std::size_t removed = (end - begin) / 4 * 4;
  end = begin + removed;
  bool safe = true;
  std::size_t ranges = 0;
  const auto in_chunk = [&](const Json& range) {
    return range["buffer"].get<std::size_t>() == *document.chunk_buffer;
  };
  each_range(document.json, [&](Json& range) {
    ++ranges;
    const std::size_t first = index_of(range, "byteOffset").value_or(0);
    const std::size_t last = first + range["byteLength"].get<std::size_t>();
    if (in_chunk(range) && first < end && last > begin) safe = false;
  });
  if (!safe || ranges != count_buffer_keys(document.json)) return;
  each_range(document.json, [&](Json& range) {
    const std::size_t first = index_of(range, "byteOffset").value_or(0);
    if (in_chunk(range) && first >= end) range["byteOffset"] = first - removed;
  });
  auto& chunk = document.binary_chunk;
  chunk.erase(chunk.begin() + static_cast<std::ptrdiff_t>(begin),
              chunk.begin() + static_cast<std::ptrdiff_t>(end));
  auto& length = document.json["buffers"][*document.chunk_buffer]["byteLength"];
  length = length.get<std::size_t>() - removed;
}

/// Takes one from every reference to a buffer view after `view`.
void renumber_views(Json& json, std::size_t view) {
  if (json.is_object())
    if (const auto other = index_of(json, "bufferView"); other && *other > view)
      json["bufferView"] = *other - 1;
  if (json.is_structured())
    for (auto& member : json) renumber_views(member, view);
}

}  // namespace

std::size_t add_buffer_view(Document& document, std::span<const std::uint8_t> bytes,
                            std::optional<int> target) {
  const auto [buffer, offset] = append(document, bytes);
  Json view = {{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (target) view["target"] = *target;
  auto& views = document.json["bufferViews"];
  views.push_back(std::move(view));
  return views.size() - 1;
}

void replace_buffer_view(Document& document, std::size_t view, std::span<const std::uint8_t> bytes) {
  const auto old = document.json["bufferViews"][view];
  const auto [buffer, offset] = append(document, bytes);
  auto& entry = document.json["bufferViews"][view];
  entry["buffer"] = buffer;
  entry["byteOffset"] = offset;
  entry["byteLength"] = bytes.size();
  if (old["buffer"].get<std::size_t>() != buffer) return;
  const std::size_t first = index_of(old, "byteOffset").value_or(0);
  erase_unused(document, first, first + old["byteLength"].get<std::size_t>());
}

void remove_buffer_view(Document& document, std::size_t view) {
  const Json old = document.json["bufferViews"][view];
  document.json["bufferViews"].erase(view);
  renumber_views(document.json, view);
  if (!document.chunk_buffer || old["buffer"].get<std::size_t>() != *document.chunk_buffer) return;
  const std::size_t first = index_of(old, "byteOffset").value_or(0);
  erase_unused(document, first, first + old["byteLength"].get<std::size_t>());
}

}  // namespace applique
