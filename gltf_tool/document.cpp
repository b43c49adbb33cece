#include "document.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "json_error.h"
#include "uri.h"

namespace applique {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67;   // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t bin_chunk = 0x004E4942;   // "BIN\0"

std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) |
         (static_cast<std::uint32_t>(bytes[at + 3]) << 24);
}

Result<Document::Json> parse_json(std::span<const std::uint8_t> text, const std::string& name) {
  try {
    Document::Json json = Document::Json::parse(text.begin(), text.end());
    if (!json.is_object())
      return fail(ErrorCode::model_invalid,
                  fmt::format("'{}': its JSON is not an object but {}", name, json.type_name()));
    return json;
  } catch (const Document::Json::exception&) {
    const std::string_view all(reinterpret_cast<const char*>(text.data()), text.size());
    return fail(ErrorCode::model_invalid,
                fmt::format("'{}': its JSON cannot be parsed: {}", name, explain_json_error(all)));
  }
}

/// Splits a GLB into its chunks (§4.4 of the glTF 2.0 specification).
Result<Document> parse_glb(std::span<const std::uint8_t> bytes, const std::string& name) {
  const auto invalid = [&](const std::string& what) {
    return fail(ErrorCode::model_invalid, fmt::format("'{}': not a valid GLB: {}", name, what));
  };
  if (bytes.size() < 12) return invalid(fmt::format("the 12-byte header ends after {} bytes", bytes.size()));
  const std::uint32_t version = read_u32(bytes, 4);
  if (version != 2)
    return fail(ErrorCode::model_unsupported,
                fmt::format("'{}': GLB version {}; only version 2 is read, convert the file to glTF 2.0",
                            name, version));
  const std::uint32_t length = read_u32(bytes, 8);
  if (length != bytes.size())
    return invalid(fmt::format("the header says {} bytes, the file has {}", length, bytes.size()));

  Document document;
  bool has_json = false;
  bool has_bin = false;
  for (std::size_t at = 12, index = 0; at < bytes.size(); ++index) {
    if (bytes.size() - at < 8) return invalid(fmt::format("the header of chunk {} is cut off", index));
    const std::uint32_t size = read_u32(bytes, at);
    const std::uint32_t type = read_u32(bytes, at + 4);
    at += 8;
    if (size > bytes.size() - at)
      return invalid(fmt::format("chunk {} says {} bytes, {} are left", index, size, bytes.size() - at));
    if (size % 4 != 0)
      return invalid(fmt::format("chunk {} is {} bytes long, not a multiple of 4", index, size));
    const auto content = bytes.subspan(at, size);
    at += size;
    if ((index == 0) != (type == json_chunk))
      return invalid(index == 0 ? "the first chunk is not JSON" : "there are two JSON chunks");
    if (type == json_chunk) {
      APPLIQUE_TRY(document.json, parse_json(content, name));
      has_json = true;
    } else if (type == bin_chunk) {
      if (has_bin) return invalid("there are two BIN chunks");
      if (index != 1) return invalid("the BIN chunk is not the second chunk");
      document.binary_chunk.assign(content.begin(), content.end());
      has_bin = true;
    } else {
      document.other_chunks.push_back({type, {content.begin(), content.end()}});
    }
  }
  if (!has_json) return invalid("it has no JSON chunk");
  const auto* buffers = find(document.json, {"buffers"});
  if (has_bin && buffers != nullptr && buffers->is_array() && !buffers->empty() &&
      buffers->front().is_object() && !buffers->front().contains("uri"))
    document.chunk_buffer = 0;
  return document;
}

/// The file behind a relative URI. Some writers leave '%' unencoded: the name as it stands is the second try.
std::filesystem::path path_of(const Document& document, const std::string& uri) {
  std::filesystem::path path = document.folder / percent_decode(uri);
  std::error_code error;
  if (!std::filesystem::exists(path, error) && std::filesystem::exists(document.folder / uri, error))
    path = document.folder / uri;
  return path;
}

}  // namespace

Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path) {
  const auto unreadable = [&](const std::string& reason) {
    return fail(ErrorCode::file_unreadable, fmt::format("cannot read '{}': {}", path.string(), reason));
  };
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return unreadable("it is a folder");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return unreadable(errno != 0 ? std::generic_category().message(errno) : "it cannot be opened");
  std::vector<std::uint8_t> bytes;
  const auto size = std::filesystem::file_size(path, error);
  if (!error) bytes.reserve(size);
  constexpr std::size_t block = 1 << 20;
  while (file) {
    const std::size_t old_size = bytes.size();
    bytes.resize(old_size + block);
    file.read(reinterpret_cast<char*>(bytes.data() + old_size), block);
    bytes.resize(old_size + static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) return unreadable(std::generic_category().message(errno));
  return bytes;
}

Result<Document> parse_document(std::span<const std::uint8_t> bytes, const std::string& name,
                                const std::filesystem::path& folder) {
  Document document;
  if (bytes.size() >= 4 && read_u32(bytes, 0) == glb_magic) {
    APPLIQUE_TRY(document, parse_glb(bytes, name));
  } else {
    if (bytes.empty()) return fail(ErrorCode::model_invalid, fmt::format("'{}': the file is empty", name));
    const auto first = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t c) { return c > ' '; });
    if (first == bytes.end() || (*first != '{' && *first != 0xEF))
      return fail(ErrorCode::model_invalid,
                  fmt::format("'{}': neither a GLB (it does not start with \"glTF\") nor JSON", name));
    APPLIQUE_TRY(document.json, parse_json(bytes, name));
    document.is_glb = false;
  }
  document.folder = folder;
  document.name = name;
  return document;
}

Result<Document> load_document(const std::filesystem::path& path) {
  APPLIQUE_TRY(const std::vector<std::uint8_t> bytes, read_file(path));
  return parse_document(bytes, path.filename().string(), path.parent_path());
}

std::size_t count_of(const Document& document, const char* collection) {
  const auto* items = find(document.json, {collection});
  return items != nullptr && items->is_array() ? items->size() : 0;
}

std::optional<std::size_t> as_index(const Document::Json& value) {
  // Parsed numbers are unsigned; those that code put there may be signed.
  if (!value.is_number_integer() || (!value.is_number_unsigned() && value.get<std::int64_t>() < 0))
    return std::nullopt;
  return value.get<std::size_t>();
}

std::optional<std::size_t> index_of(const Document::Json& object, const char* key) {
  const auto* value = find(object, {key});
  return value != nullptr ? as_index(*value) : std::nullopt;
}

const Document::Json* find(const Document::Json& object, std::initializer_list<const char*> keys) {
  const Document::Json* value = &object;
  for (const char* key : keys) {
    if (!value->is_object()) return nullptr;
    const auto member = value->find(key);
    if (member == value->end()) return nullptr;
    value = &*member;
  }
  return value;
}

Result<std::vector<std::uint8_t>> read_uri(const Document& document, const std::string& uri,
                                           const std::string& what) {
  if (const auto file = document.new_files.find(uri); file != document.new_files.end()) return file->second;
  if (is_data_uri(uri)) return decode_data_uri(uri, what);
  if (!is_relative_uri(uri))
    return fail(
        ErrorCode::model_unsupported,
        fmt::format("{}: '{}' is not a relative path; put the file beside the model and name it there", what,
                    uri));
  auto bytes = read_file(path_of(document, uri));
  if (!bytes) return fail(bytes.error().code, fmt::format("{}: {}", what, bytes.error().message));
  return bytes;
}

std::vector<std::filesystem::path> files_of(const Document& document) {
  std::vector<std::filesystem::path> files;
  for (const char* collection : {"buffers", "images"})
    for (std::size_t i = 0; i < count_of(document, collection); ++i)
      if (const auto* uri = find(document.json[collection][i], {"uri"}); uri != nullptr && uri->is_string())
        if (const auto name = uri->get<std::string>();
            is_relative_uri(name) && !document.new_files.contains(name))
          files.push_back(path_of(document, name));
  return files;
}

std::optional<std::filesystem::path> missing_file(const Document& document, std::size_t image) {
  const auto* uri = find(document.json["images"][image], {"uri"});
  if (uri == nullptr || !uri->is_string()) return std::nullopt;
  const auto name = uri->get<std::string>();
  if (!is_relative_uri(name) || document.new_files.contains(name)) return std::nullopt;
  const std::filesystem::path path = path_of(document, name);
  if (std::error_code error; std::filesystem::exists(path, error)) return std::nullopt;
  return path;
}

Result<Buffers> read_buffers(const Document& document) {
  Buffers buffers;
  const std::size_t count = count_of(document, "buffers");
  buffers.owned.resize(count);
  buffers.bytes.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& buffer = document.json["buffers"][i];
    const std::size_t length = buffer["byteLength"].get<std::size_t>();
    if (document.chunk_buffer == i) {
      buffers.bytes[i] = document.binary_chunk;
    } else if (buffer.contains("uri")) {
      APPLIQUE_TRY(buffers.owned[i], read_uri(document, buffer["uri"].get<std::string>(),
                                              fmt::format("'{}', buffer {}", document.name, i)));
      buffers.bytes[i] = buffers.owned[i];
    } else {
      continue;
    }
    if (buffers.bytes[i].size() < length)
      return fail(ErrorCode::model_invalid,
                  fmt::format("'{}', buffer {}: byteLength is {}, but only {} bytes are there", document.name,
                              i, length, buffers.bytes[i].size()));
    buffers.bytes[i] = buffers.bytes[i].first(length);
  }
  return buffers;
}

Result<std::vector<std::uint8_t>> read_image_bytes(const Document& document, std::size_t image) {
  const auto& entry = document.json["images"][image];
  const std::string what = fmt::format("'{}', image {}", document.name, image);
  if (const auto* uri = find(entry, {"uri"}); uri != nullptr)
    return read_uri(document, uri->get<std::string>(), what);
  const auto view_index = index_of(entry, "bufferView");
  if (!view_index) return fail(ErrorCode::model_invalid, what + ": it has neither a uri nor a bufferView");
  const auto& view = document.json["bufferViews"][*view_index];
  const std::size_t offset = index_of(view, "byteOffset").value_or(0);
  const std::size_t length = view["byteLength"].get<std::size_t>();
  const std::size_t buffer = view["buffer"].get<std::size_t>();
  std::vector<std::uint8_t> storage;
  std::span<const std::uint8_t> bytes = document.binary_chunk;
  if (document.chunk_buffer != buffer) {
    const auto* uri = find(document.json["buffers"][buffer], {"uri"});
    if (uri == nullptr)
      return fail(ErrorCode::model_invalid, fmt::format("{}: buffer {} has no bytes", what, buffer));
    APPLIQUE_TRY(storage,
                 read_uri(document, uri->get<std::string>(), fmt::format("{}, buffer {}", what, buffer)));
    bytes = storage;
  }
  if (offset > bytes.size() || length > bytes.size() - offset)
    return fail(ErrorCode::model_invalid, what + ": its bytes lie beyond the end of its buffer");
  bytes = bytes.subspan(offset, length);
  return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
}

}  // namespace applique
