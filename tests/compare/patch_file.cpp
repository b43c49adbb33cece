#include "compare/patch_file.h"

#include <utility>

#include <fmt/format.h>

#include "applique/image/image.h"

#include "glb_writer.h"
#include "model.h"

namespace applique::compare {
namespace {

std::array<double, 2> uv_of(Vec2 z, const ImageFrame& frame) {
  const Pixel p = frame.to_pixel(z);
  return {p.x / frame.width, p.y / frame.height};
}

}  // namespace

Result<void> write_patch(const std::filesystem::path& path, const std::string& name, const Site& site,
                         const DecalMap& map, const ImageFrame& frame) {
  assets::Mesh mesh;
  IdVector<PatchVertexId, std::uint32_t> index(map.patch.vertices.size(), 0);
  for (const PatchVertexId v : ids<PatchVertexId>(map.patch.vertices.size())) {
    const VertexId over = map.patch.vertices[v];
    if (!over.valid()) continue;
    index[v] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(site.mesh.positions[over]);
    const auto [s, t] = uv_of(map.image[v], frame);
    mesh.uvs.emplace_back(s, t);
  }
  mesh.normals.assign(mesh.positions.size(), Vec3::Zero());
  for (const PatchFace& face : map.patch.faces) {
    if (!face.mesh_face.valid()) continue;
    const auto& v = face.vertices;
    mesh.triangles.push_back({index[v[0]], index[v[1]], index[v[2]]});
    const auto corners = site.mesh.corners(face.mesh_face);
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    for (const std::uint32_t i : mesh.triangles.back()) mesh.normals[i] += normal;
  }
  // Square, so that no program makes up for the texture's shape.
  constexpr int texture_size = 8;
  constexpr std::uint16_t full = 65535;
  return assets::write_glb(path, mesh, make_image(texture_size, texture_size, {full, full, full, full}),
                           {name});
}

Result<PatchFile> read_patch(const std::filesystem::path& path) {
  APPLIQUE_TRY(const Model model, load_model(path));
  PatchFile file;
  for (const ModelPart& part : model.parts) {
    if (part.uvs.empty())
      return fail(ErrorCode::model_invalid,
                  fmt::format("{}: no TEXCOORD_0 on mesh {}", path.string(), part.mesh));
    const auto first = static_cast<std::uint32_t>(file.positions.size());
    file.positions.insert(file.positions.end(), part.positions.begin(), part.positions.end());
    file.uvs.insert(file.uvs.end(), part.uvs.begin(), part.uvs.end());
    for (const auto& [a, b, c] : part.triangles) file.triangles.push_back({first + a, first + b, first + c});
    file.name = model.document.json["nodes"][part.node].value("name", "");
  }
  if (file.triangles.empty())
    return fail(ErrorCode::model_invalid, fmt::format("{}: no triangles", path.string()));
  return file;
}

}  // namespace applique::compare
