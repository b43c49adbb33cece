#include "save_document.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "binary_edit.h"
#include "media_type.h"
#include "output_file.h"
#include "unpack_images.h"
#include "uri.h"

namespace applique {
namespace {

using Json = Document::Json;
namespace fs = std::filesystem;

struct SideFile {
  fs::path path;  ///< Relative to the output's folder.
  std::vector<std::uint8_t> bytes;
};

bool declares(const Document& document, const char* extension) {
  const auto* used = find(document.json, {"extensionsUsed"});
  return used != nullptr && used->is_array() &&
         std::find(used->begin(), used->end(), extension) != used->end();
}

/// The media type of an image that the document may embed, by its first bytes; "" for another.
std::string embeddable_type(const Document& document, std::span<const std::uint8_t> bytes) {
  const std::string type = media_type_of(bytes);
  if (type == "image/webp" && !declares(document, "EXT_texture_webp")) return "";
  if (type == "image/ktx2" && !declares(document, "KHR_texture_basisu")) return "";
  return type;
}

void put_u32(std::vector<std::uint8_t>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void put_chunk(std::vector<std::uint8_t>& out, std::uint32_t type, std::span<const std::uint8_t> bytes,
               std::uint8_t padding) {
  put_u32(out, (bytes.size() + 3) / 4 * 4);
  put_u32(out, type);
  out.insert(out.end(), bytes.begin(), bytes.end());
  out.resize((out.size() + 3) / 4 * 4, padding);
}

Result<std::vector<std::uint8_t>> to_glb(const Document& document, const fs::path& path) {
  const std::string text = document.json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::vector<std::uint8_t> out;
  out.reserve(text.size() + document.binary_chunk.size() + 64);
  put_u32(out, 0x46546C67);
  put_u32(out, 2);
  put_u32(out, 0);
  put_chunk(out, 0x4E4F534A, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, ' ');
  if (!document.binary_chunk.empty()) put_chunk(out, 0x004E4942, document.binary_chunk, 0);
  for (const auto& chunk : document.other_chunks) put_chunk(out, chunk.type, chunk.bytes, 0);
  if (out.size() > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::output_unwritable,
                fmt::format("{}: cannot be written: a GLB holds at most 4 GiB; write a .gltf instead",
                            path.string()));
  std::vector<std::uint8_t> length;
  put_u32(length, out.size());
  std::copy(length.begin(), length.end(), out.begin() + 8);
  return out;
}

/// Moves all buffers that have bytes into the chunk, as buffer 0.
Result<void> pack_buffers(Document& document) {
  if (count_of(document, "buffers") == 0) return {};
  APPLIQUE_TRY(const Buffers buffers, read_buffers(document));
  std::vector<std::uint8_t> chunk;
  Json entries = Json::array({Json::object()});
  std::vector<std::pair<std::size_t, std::size_t>> place;  // buffer -> (new buffer, offset)
  for (std::size_t i = 0; i < buffers.bytes.size(); ++i) {
    Json entry = document.json["buffers"][i];
    if (buffers.bytes[i].empty()) {
      place.emplace_back(entries.size(), 0);
      entries.push_back(std::move(entry));
      continue;
    }
    chunk.resize((chunk.size() + 3) / 4 * 4);
    place.emplace_back(0, chunk.size());
    chunk.insert(chunk.end(), buffers.bytes[i].begin(), buffers.bytes[i].end());
    entry.erase("uri");
    entries[0].insert(entry.begin(), entry.end());
  }
  if (chunk.empty()) return {};
  entries[0]["byteLength"] = chunk.size();
  const auto move = [&](Json& range) {
    const auto [buffer, offset] = place[range["buffer"].get<std::size_t>()];
    range["buffer"] = buffer;
    if (offset != 0) range["byteOffset"] = index_of(range, "byteOffset").value_or(0) + offset;
  };
  for (std::size_t i = 0; i < count_of(document, "bufferViews"); ++i) {
    auto& view = document.json["bufferViews"][i];
    move(view);
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (find(view, {"extensions", extension}) != nullptr) move(view["extensions"][extension]);
  }
  document.json["buffers"] = std::move(entries);
  document.binary_chunk = std::move(chunk);
  document.chunk_buffer = 0;
  return {};
}

/// Moves the images that can be read into the chunk.
void pack_images(Document& document) {
  for (std::size_t i = 0; i < count_of(document, "images"); ++i) {
    const auto* uri = find(document.json["images"][i], {"uri"});
    if (uri == nullptr) continue;
    const auto bytes = read_uri(document, uri->get<std::string>(), "image");
    const std::string type = bytes ? embeddable_type(document, *bytes) : "";
    if (type.empty()) continue;
    const std::size_t view = add_buffer_view(document, *bytes);
    auto& image = document.json["images"][i];
    image.erase("uri");
    if (!image.contains("mimeType")) image["mimeType"] = type;
    image["bufferView"] = view;
  }
}

/// The files behind relative URIs, which get names that fit the output's folder.
class SideFiles {
 public:
  SideFiles(Document& document, const fs::path& path, const std::vector<fs::path>& keep)
      : document_(document),
        stem_(path.stem().string()),
        folder_(path.has_parent_path() ? path.parent_path() : ".") {
    std::error_code error;
    const fs::path source = document.folder.empty() ? "." : document.folder;
    same_folder_ = fs::equivalent(folder_, source, error);
    for (const fs::path& file : keep) keep_.insert(full_path(file));
    for (const char* collection : {"buffers", "images"})
      for (std::size_t i = 0; i < count_of(document, collection); ++i)
        if (const auto* uri = find(document.json[collection][i], {"uri"}))
          used_.insert(uri->get<std::string>());
  }

  Result<std::vector<SideFile>> collect() {
    for (const char* collection : {"buffers", "images"})
      for (std::size_t i = 0; i < count_of(document_, collection); ++i)
        APPLIQUE_CHECK(take(document_.json[collection][i], std::string_view(collection) == "buffers"));
    return std::move(files_);
  }

  void name_chunk() {
    auto& buffer = document_.json["buffers"][*document_.chunk_buffer];
    const std::string name = free_name(stem_, ".bin");
    buffer["uri"] = percent_encode(name);
    document_.binary_chunk.resize(buffer["byteLength"].get<std::size_t>());
    files_.push_back({name, std::move(document_.binary_chunk)});
    named_.insert(percent_encode(name));
  }

 private:
  Result<void> take(Json& entry, bool required) {
    const auto* member = find(entry, {"uri"});
    if (member == nullptr) return {};
    const std::string uri = member->get<std::string>();
    if (is_data_uri(uri) || !is_relative_uri(uri) || named_.contains(uri)) return {};
    const bool is_new = document_.new_files.contains(uri);
    if (!is_new && same_folder_) return {};
    const auto [renamed, first] = renamed_.try_emplace(uri, uri);
    if (!first) {
      entry["uri"] = renamed->second;
      return {};
    }
    auto bytes = read_uri(document_, uri, "side file");
    if (!bytes) {
      if (required) return tl::unexpected<Error>(bytes.error());
      return {};
    }
    fs::path name = fs::path(is_new ? uri : percent_decode(uri)).lexically_normal();
    const bool outside = *name.begin() == "..";
    if (outside) name = name.filename();
    const bool taken = outside && used_.contains(percent_encode(name.string()));
    if (is_new || taken || is_kept(name) || is_another(name, *bytes))
      name = name_after_output(name.filename());
    if (is_new || percent_decode(uri) != name.string()) {
      renamed->second = percent_encode(name.string());
      entry["uri"] = renamed->second;
    }
    used_.insert(percent_encode(name.string()));
    files_.push_back({name, std::move(*bytes)});
    return {};
  }

  /// Whether the output's folder has a file of this name with other bytes, which may belong to another model.
  [[nodiscard]] bool is_another(const fs::path& name, const std::vector<std::uint8_t>& bytes) const {
    std::error_code error;
    const auto size = fs::file_size(folder_ / name, error);
    if (error) return fs::exists(folder_ / name, error);
    if (size != bytes.size()) return true;
    std::ifstream file(folder_ / name, std::ios::binary);
    const std::vector<char> there{std::istreambuf_iterator<char>(file), {}};
    return !std::equal(there.begin(), there.end(), bytes.begin(), bytes.end(),
                       [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
  }

  /// A free name that begins with the output's own, so that outputs in one folder do not take each other's.
  std::string name_after_output(const fs::path& name) {
    const std::string stem = name.stem().string();
    const bool has_it = stem == stem_ || stem.starts_with(stem_ + "_");
    return free_name(has_it ? stem : stem_ + "_" + stem, name.extension().string());
  }

  std::string free_name(const std::string& stem, const std::string& extension) {
    std::string name = stem + extension;
    for (int i = 2; used_.contains(percent_encode(name)) || used_.contains(name) || is_kept(name); ++i)
      name = fmt::format("{}_{}{}", stem, i, extension);
    used_.insert(percent_encode(name));
    return name;
  }

  /// Whether a name in the output's folder is that of a file that must stay.
  [[nodiscard]] bool is_kept(const fs::path& name) const { return keep_.contains(full_path(folder_ / name)); }

  Document& document_;
  std::string stem_;
  fs::path folder_;
  std::set<fs::path> keep_;
  bool same_folder_ = false;
  std::set<std::string> used_;                  ///< URIs that are taken.
  std::set<std::string> named_;                 ///< URIs that are final.
  std::map<std::string, std::string> renamed_;  ///< URI before -> URI in the output.
  std::vector<SideFile> files_;
};

/// The document's own file, and those beside it.
Result<void> write_all(const fs::path& path, std::span<const std::uint8_t> bytes,
                       const std::vector<SideFile>& beside) {
  std::vector<OutputFile> files;
  for (const SideFile& file : beside) {
    files.push_back({path.parent_path() / file.path, file.bytes});
    const fs::path folder = files.back().path.parent_path();
    std::error_code error;
    if (!folder.empty()) fs::create_directories(folder, error);
    if (error)
      return fail(ErrorCode::output_unwritable,
                  fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  files.push_back({path, bytes});
  return write_files(files);
}

}  // namespace

Result<void> save_document(const Document& document, const fs::path& path,
                           const std::vector<fs::path>& keep) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".glb" && extension != ".gltf")
    return fail(ErrorCode::output_unwritable,
                fmt::format("{}: the name of the output ends in .glb or .gltf, which says its format",
                            path.string()));
  APPLIQUE_CHECK(check_writable(path));
  Document output = document;
  const bool as_glb = extension == ".glb";
  if (as_glb && (!output.is_glb || output.chunk_buffer.value_or(0) != 0)) {
    APPLIQUE_CHECK(pack_buffers(output));
    pack_images(output);
  }
  if (!as_glb) unpack_images(output);
  SideFiles side_files(output, path, keep);
  if (!as_glb && output.chunk_buffer) side_files.name_chunk();
  APPLIQUE_TRY(const auto files, side_files.collect());
  if (as_glb) {
    APPLIQUE_TRY(const auto bytes, to_glb(output, path));
    return write_all(path, bytes, files);
  }
  const std::string text = output.json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return write_all(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, files);
}

}  // namespace applique
