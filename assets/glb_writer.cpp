#include "glb_writer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace applique::assets {
namespace {

using nlohmann::json;

/// glTF's numbers for types and targets.
constexpr int float_type = 5126;
constexpr int unsigned_int_type = 5125;
constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;

/// The binary chunk and the views into it.
struct Buffer {
  std::vector<std::uint8_t> bytes;
  json views = json::array();

  template <class T>
  int add(const std::vector<T>& items, int target) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json view{{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", sizeof(T) * items.size()}};
    if (target != 0) view["target"] = target;
    const std::size_t start = bytes.size();
    bytes.resize(start + sizeof(T) * items.size());
    std::memcpy(bytes.data() + start, items.data(), sizeof(T) * items.size());
    views.push_back(view);
    return static_cast<int>(views.size()) - 1;
  }
};

void append(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

void append_chunk(std::vector<std::uint8_t>& out, std::uint32_t type, std::span<const std::uint8_t> data,
                  char padding) {
  const std::size_t padded = (data.size() + 3) / 4 * 4;
  append(out, static_cast<std::uint32_t>(padded));
  append(out, type);
  out.insert(out.end(), data.begin(), data.end());
  out.resize(out.size() + padded - data.size(), static_cast<std::uint8_t>(padding));
}

}  // namespace

Result<void> write_glb(const std::filesystem::path& path, const Mesh& mesh, const Image& texture,
                       const GlbOptions& options) {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::array<float, 2>> uvs;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector3f high = -low;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector3f p = mesh.positions[v].cast<float>();
    const Eigen::Vector3f n = mesh.normals[v].normalized().cast<float>();
    const Eigen::Vector2f uv = mesh.uvs[v].cast<float>();
    positions.push_back({p.x(), p.y(), p.z()});
    normals.push_back({n.x(), n.y(), n.z()});
    uvs.push_back({uv.x(), uv.y()});
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  APPLIQUE_TRY(const std::vector<std::uint8_t> png, encode_png(texture));

  Buffer buffer;
  const auto accessor = [](int view, int type, std::size_t count, const char* kind) {
    return json{{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", kind}};
  };
  json accessors = json::array();
  accessors.push_back(accessor(buffer.add(positions, array_buffer), float_type, positions.size(), "VEC3"));
  accessors[0]["min"] = {low.x(), low.y(), low.z()};
  accessors[0]["max"] = {high.x(), high.y(), high.z()};
  accessors.push_back(accessor(buffer.add(normals, array_buffer), float_type, normals.size(), "VEC3"));
  accessors.push_back(accessor(buffer.add(uvs, array_buffer), float_type, uvs.size(), "VEC2"));
  accessors.push_back(accessor(buffer.add(mesh.triangles, element_array_buffer), unsigned_int_type,
                               3 * mesh.triangles.size(), "SCALAR"));
  const int image_view = buffer.add(png, 0);
  buffer.bytes.resize((buffer.bytes.size() + 3) / 4 * 4);

  const json document{
      {"asset", {{"version", "2.0"}, {"generator", "applique_assets"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"name", options.name}, {"mesh", 0}}}},
      {"meshes",
       {{{"name", options.name},
         {"primitives",
          {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}},
            {"indices", 3},
            {"material", 0}}}}}}},
      {"materials",
       {{{"name", options.name},
         {"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}}},
           {"metallicFactor", options.metallic},
           {"roughnessFactor", options.roughness}}}}}},
      {"textures", {{{"source", 0}, {"sampler", 0}}}},
      {"samplers", {{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 10497}}}},
      {"images", {{{"name", options.name}, {"mimeType", "image/png"}, {"bufferView", image_view}}}},
      {"accessors", accessors},
      {"bufferViews", buffer.views},
      {"buffers", {{{"byteLength", buffer.bytes.size()}}}},
  };
  const std::string text = document.dump();
  std::vector<std::uint8_t> body;
  const std::span<const char> characters(text);
  append_chunk(body, 0x4E4F534A, std::vector<std::uint8_t>(characters.begin(), characters.end()), ' ');
  append_chunk(body, 0x004E4942, buffer.bytes, 0);
  std::vector<std::uint8_t> file;
  append(file, 0x46546C67);
  append(file, 2);
  append(file, static_cast<std::uint32_t>(12 + body.size()));
  file.insert(file.end(), body.begin(), body.end());
  return write_file(path, file);
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return fail(ErrorCode::output_unwritable, fmt::format("{}: cannot be written", path.string()));
  return {};
}

}  // namespace applique::assets
