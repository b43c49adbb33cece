#include "cli/small_model.h"

#include <fstream>
#include <span>

#include <nlohmann/json.hpp>

namespace applique {
namespace {

using nlohmann::json;

template <class T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof(T));
}

/// A glTF buffer that grows by aligned views.
struct BufferWriter {
  std::vector<std::uint8_t> bytes;
  json views = json::array();
  json accessors = json::array();

  std::size_t add_view(std::span<const std::uint8_t> data) {
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}});
    bytes.insert(bytes.end(), data.begin(), data.end());
    bytes.resize((bytes.size() + 3) / 4 * 4, 0);
    return views.size() - 1;
  }

  std::size_t add_floats(const std::vector<std::vector<double>>& rows, const char* type) {
    std::vector<std::uint8_t> data;
    auto lower = rows[0];
    auto upper = rows[0];
    for (const auto& row : rows)
      for (std::size_t i = 0; i < row.size(); ++i) {
        append(data, static_cast<float>(row[i]));
        lower[i] = std::min(lower[i], row[i]);
        upper[i] = std::max(upper[i], row[i]);
      }
    const std::size_t view = add_view(data);
    accessors.push_back({{"bufferView", view},
                         {"componentType", 5126},
                         {"count", rows.size()},
                         {"type", type},
                         {"min", lower},
                         {"max", upper}});
    return accessors.size() - 1;
  }

  std::size_t add_indices(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::vector<std::uint8_t> data;
    for (const auto& triangle : triangles)
      for (const std::uint32_t index : triangle) append(data, index);
    const std::size_t view = add_view(data);
    accessors.push_back(
        {{"bufferView", view}, {"componentType", 5125}, {"count", 3 * triangles.size()}, {"type", "SCALAR"}});
    return accessors.size() - 1;
  }
};

json write_mesh(BufferWriter& buffer, const SmallMesh& mesh) {
  const auto rows = [](const std::vector<Vec3>& vectors) {
    std::vector<std::vector<double>> list;
    for (const Vec3& v : vectors) list.push_back({v.x(), v.y(), v.z()});
    return list;
  };
  json attributes = {{"POSITION", buffer.add_floats(rows(mesh.positions), "VEC3")}};
  if (!mesh.normals.empty()) attributes["NORMAL"] = buffer.add_floats(rows(mesh.normals), "VEC3");
  if (!mesh.uvs.empty()) {
    std::vector<std::vector<double>> uvs;
    for (const auto& uv : mesh.uvs) uvs.push_back({uv[0], uv[1]});
    attributes["TEXCOORD_0"] = buffer.add_floats(uvs, "VEC2");
  }
  json primitive = {{"attributes", attributes}, {"indices", buffer.add_indices(mesh.triangles)}};
  if (mesh.material >= 0) primitive["material"] = mesh.material;
  return {{"name", mesh.name}, {"primitives", json::array({primitive})}};
}

void write_chunk(std::ofstream& file, std::uint32_t type, const std::vector<std::uint8_t>& bytes) {
  const auto length = static_cast<std::uint32_t>(bytes.size());
  file.write(reinterpret_cast<const char*>(&length), sizeof length);
  file.write(reinterpret_cast<const char*>(&type), sizeof type);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

SmallMesh make_plane(const std::string& name, int cells, double x, double z) {
  SmallMesh mesh;
  mesh.name = name;
  const auto index = [cells](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double u = static_cast<double>(i) / cells;
      const double v = static_cast<double>(j) / cells;
      mesh.positions.emplace_back(x - 1 + 2 * u, 1 - 2 * v, z);
      mesh.uvs.push_back({u, v});
      if (i == cells || j == cells) continue;
      mesh.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
    }
  return mesh;
}

void write_small_model(const std::filesystem::path& path, const std::vector<SmallMesh>& meshes,
                       const std::vector<SmallMaterial>& materials) {
  BufferWriter buffer;
  json document = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::vector<std::size_t> roots;
  for (const SmallMesh& mesh : meshes) {
    roots.push_back(roots.size());
    document["nodes"].push_back({{"name", mesh.name}, {"mesh", roots.back()}});
    document["meshes"].push_back(write_mesh(buffer, mesh));
  }
  document["scenes"] = json::array({{{"nodes", roots}}});
  for (const SmallMaterial& material : materials) {
    json pbr = {{"baseColorFactor", material.factor}, {"metallicFactor", 0}};
    if (material.texture) {
      const auto png = encode_png(*material.texture);
      document["images"].push_back({{"bufferView", buffer.add_view(png.value())}, {"mimeType", "image/png"}});
      document["textures"].push_back({{"source", document["images"].size() - 1}});
      pbr["baseColorTexture"] = {{"index", document["textures"].size() - 1}};
    }
    document["materials"].push_back({{"name", material.name}, {"pbrMetallicRoughness", pbr}});
  }
  document["bufferViews"] = buffer.views;
  document["accessors"] = buffer.accessors;
  document["buffers"] = json::array({{{"byteLength", buffer.bytes.size()}}});

  const std::string text = document.dump();
  std::vector<std::uint8_t> json_bytes(text.begin(), text.end());
  json_bytes.resize((json_bytes.size() + 3) / 4 * 4, ' ');
  std::ofstream file(path, std::ios::binary);
  const std::array<std::uint32_t, 3> header = {
      0x46546c67, 2, static_cast<std::uint32_t>(12 + 8 + json_bytes.size() + 8 + buffer.bytes.size())};
  file.write(reinterpret_cast<const char*>(header.data()), sizeof header);
  write_chunk(file, 0x4e4f534a, json_bytes);
  write_chunk(file, 0x004e4942, buffer.bytes);
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const auto png = encode_png(image).value();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
}

Image make_noise(int size) {
  Image image = make_image(size, size, {0, 0, 0, 0xffff});
  image.channels = 3;
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    state = 1664525 * state + 1013904223;
    if (i % 4 != 3) image.rgba[i] = static_cast<std::uint16_t>(257 * (state >> 24));
  }
  return image;
}

}  // namespace applique
