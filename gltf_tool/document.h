#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "applique/base/error.h"

namespace applique {

/// A glTF file as it stands: its JSON in its own order, and its binary chunk. Edits touch only what they are
/// for, so that everything else (extras, unknown extensions, buffers, images) is written as it was read.
/// tinygltf, which parses geometry, would drop what it does not know when writing.
// nlohmann's move constructor asserts behind a catch, which clang-tidy takes for a throw.
struct Document {  // NOLINT(bugprone-exception-escape)
  using Json = nlohmann::ordered_json;

  /// A GLB chunk of a type that glTF does not define; kept as it is.
  struct Chunk {
    std::uint32_t type = 0;
    std::vector<std::uint8_t> bytes;
  };

  Json json;
  std::vector<std::uint8_t> binary_chunk;  ///< The GLB's BIN chunk, or what edits added to a .gltf.
  std::optional<std::size_t>
      chunk_buffer;  ///< The buffer whose bytes are `binary_chunk`; none if there is none.
  std::vector<Chunk> other_chunks;
  std::map<std::string, std::vector<std::uint8_t>>
      new_files;                 ///< Files that edits made, by URI; not yet on disk.
  std::filesystem::path folder;  ///< Where relative URIs start.
  std::string name;              ///< The file's name, for messages.
  bool is_glb = true;
};

/// Reads a .glb or .gltf (told apart by content). Checks the container and the JSON's syntax; check_document
/// checks the content. Errors: file_unreadable, model_invalid, model_unsupported (glTF 1).
Result<Document> load_document(const std::filesystem::path& path);

/// The same from bytes; `name` stands for the file in errors, `folder` is where relative URIs start.
Result<Document> parse_document(std::span<const std::uint8_t> bytes, const std::string& name,
                                const std::filesystem::path& folder);

/// Checks what decoding and editing rely on: collections are arrays of objects, indices point at something,
/// buffer views lie in their buffers, nodes form trees, required extensions are known. Errors: model_invalid,
/// model_unsupported, each naming the offender ("mesh 3, primitive 0: …").
Result<void> check_document(const Document& document);

/// The bytes of every buffer. A buffer without bytes of its own (the fallback of a compression) is empty.
struct Buffers {
  std::vector<std::vector<std::uint8_t>> owned;
  std::vector<std::span<const std::uint8_t>> bytes;  ///< By buffer; into `owned` or the document's chunk.
};

/// Reads the buffers of a checked document, which must outlive the result. Errors: file_unreadable (the
/// missing file), model_invalid (a buffer is shorter than its byteLength).
Result<Buffers> read_buffers(const Document& document);

/// The bytes behind a URI of the document: a new file, a data URI or a file beside the document. `what` names
/// the owner in errors ("image 2").
Result<std::vector<std::uint8_t>> read_uri(const Document& document, const std::string& uri,
                                           const std::string& what);

/// The files that a document's buffers and images are read from, by relative URIs.
std::vector<std::filesystem::path> files_of(const Document& document);

/// The file of an image that is not there; none when it is, or when the image is no file.
std::optional<std::filesystem::path> missing_file(const Document& document, std::size_t image);

/// The bytes of an image as stored (PNG, JPEG, …). Errors: as read_uri, model_invalid.
Result<std::vector<std::uint8_t>> read_image_bytes(const Document& document, std::size_t image);

/// The number of objects in a root collection: count_of(document, "nodes"); 0 if it is missing.
std::size_t count_of(const Document& document, const char* collection);

/// A non-negative integer; none when the value is anything else.
std::optional<std::size_t> as_index(const Document::Json& value);

/// A non-negative integer member; none when it is missing or anything else.
std::optional<std::size_t> index_of(const Document::Json& object, const char* key);

/// A member by a chain of keys, nullptr when any is missing: find(material, {"pbrMetallicRoughness",
/// "baseColorTexture"}).
const Document::Json* find(const Document::Json& object, std::initializer_list<const char*> keys);

/// Reads a whole file. Errors: file_unreadable, naming the path and the reason.
Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path);

}  // namespace applique
