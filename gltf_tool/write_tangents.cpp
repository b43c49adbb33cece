#include "write_tangents.h"

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "binary_edit.h"
#include "geometry.h"
#include "tangents.h"

namespace applique {
namespace {

void add_tangents(Document& document, const ModelPart& part,
                  const std::vector<std::array<float, 4>>& tangents) {
  constexpr int array_buffer = 34962, floats = 5126;
  const auto bytes = std::span(reinterpret_cast<const std::uint8_t*>(tangents.data()), 16 * tangents.size());
  const std::size_t view = add_buffer_view(document, bytes, array_buffer);
  auto& accessors = document.json["accessors"];
  const std::size_t mesh = document.json["nodes"][part.node]["mesh"].get<std::size_t>();
  document.json["meshes"][mesh]["primitives"][part.primitive]["attributes"]["TANGENT"] = accessors.size();
  accessors.push_back(
      {{"bufferView", view}, {"componentType", floats}, {"count", tangents.size()}, {"type", "VEC4"}});
}

}  // namespace

Result<std::optional<ModelPart>> in_own_space(const ModelPart& part, const tinygltf::Model& geometry) {
  const auto& primitive = geometry.meshes[part.mesh].primitives[part.primitive];
  if (!primitive.attributes.contains("NORMAL")) return std::nullopt;
  ModelPart own = part;
  const auto read = [&](const char* name) {
    return read_accessor(geometry, primitive.attributes.at(name), 3,
                         fmt::format("mesh {}, primitive {}, {}", part.mesh, part.primitive, name));
  };
  APPLIQUE_TRY(const auto positions, read("POSITION"));
  APPLIQUE_TRY(const auto normals, read("NORMAL"));
  own.positions = to_vectors(positions);
  own.normals = to_vectors(normals);
  if (part.mirrored)
    for (auto& triangle : own.triangles) std::swap(triangle[1], triangle[2]);
  return own;
}

Result<void> write_tangents(const Model& model, std::span<const BakeTarget> targets, Document& document) {
  std::optional<tinygltf::Model> geometry;
  for (const BakeTarget& target : targets) {
    if (target.slot != MaterialSlot::normal || has_texture(model, target)) continue;
    for (const std::uint32_t index : target.parts) {
      const ModelPart& part = model.parts[index];
      if (!part.tangents.empty() || part.mirrored) continue;
      if (!geometry) {
        APPLIQUE_TRY(const Buffers buffers, read_buffers(model.document));
        APPLIQUE_TRY(geometry, decode_geometry(model.document, buffers));
      }
      APPLIQUE_TRY(const auto own, in_own_space(part, *geometry));
      if (!own) continue;
      const auto tangents =
          vertex_tangents(*own, tangent_frames(*own, slot_uvs(model, part, MaterialSlot::normal)));
      if (tangents) add_tangents(document, part, *tangents);
    }
  }
  return {};
}

void make_tangents(OverlayMesh& overlay) {
  if (overlay.joints_mirror) return;
  ModelPart part;
  part.positions = overlay.positions;
  part.normals = overlay.normals;
  part.triangles = overlay.triangles;
  if (auto tangents = vertex_tangents(part, tangent_frames(part, overlay.uvs)))
    overlay.tangents = std::move(*tangents);
}

}  // namespace applique
