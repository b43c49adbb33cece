#include "model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <unordered_map>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry.h"
#include "material.h"
#include "posing.h"
#include "texture_slots.h"

namespace applique {
namespace {

using Eigen::Matrix4d;

/// A file of a few kilobytes can draw one mesh from very many nodes; more than this is not a model to pin
/// decals on.
constexpr std::size_t max_triangles = std::size_t{1} << 26;

/// The matrix that carries normals: the inverse transpose of the linear part, up to a positive factor.
Eigen::Matrix3d normal_matrix(const Matrix4d& matrix) {
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  Eigen::Matrix3d cofactor;
  for (int c = 0; c < 3; ++c) cofactor.col(c) = linear.col((c + 1) % 3).cross(linear.col((c + 2) % 3));
  return linear.determinant() < 0 ? Eigen::Matrix3d(-cofactor) : cofactor;
}

struct PositionHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::size_t seed = 0;
    for (const double x : p) seed = seed * 0x9E3779B97F4A7C15ULL + std::hash<double>()(x == 0 ? 0.0 : x);
    return seed;
  }
};

/// Gives those parts of a node that have none area-weighted vertex normals, smooth across vertices at one
/// position: a border between primitives is no crease.
void add_smooth_normals(std::span<ModelPart> parts) {
  std::unordered_map<std::array<double, 3>, Vec3, PositionHash> sums;
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p.x(), p.y(), p.z()}; };
  for (const ModelPart& part : parts) {
    if (!part.normals.empty()) continue;
    for (const auto& t : part.triangles) {
      const Vec3 normal =
          (part.positions[t[1]] - part.positions[t[0]]).cross(part.positions[t[2]] - part.positions[t[0]]);
      for (const std::uint32_t corner : t)
        sums.try_emplace(key(part.positions[corner]), Vec3::Zero()).first->second += normal;
    }
  }
  for (ModelPart& part : parts) {
    if (!part.normals.empty()) continue;
    part.normals.assign(part.positions.size(), Vec3::UnitZ());
    for (std::size_t i = 0; i < part.normals.size(); ++i)
      if (const auto sum = sums.find(key(part.positions[i])); sum != sums.end())
        part.normals[i] = sum->second;
  }
}

/// Decodes the parts that the default scene shows.
class PartReader {
 public:
  PartReader(const Document& document, const tinygltf::Model& model, std::vector<Warning>& warnings)
      : document_(document), model_(model), warnings_(warnings) {}

  Result<std::vector<ModelPart>> run() {
    world_ = world_matrices(model_);
    list_shown_nodes();
    std::vector<ModelPart> parts;
    for (const std::size_t node : shown_) {
      const int mesh = model_.nodes[node].mesh;
      if (mesh < 0) continue;
      if (find(document_.json["nodes"][node], {"extensions", "EXT_mesh_gpu_instancing"}) != nullptr)
        warnings_.push_back(
            {"instancing_ignored", fmt::format("node {}: EXT_mesh_gpu_instancing is not followed; the mesh "
                                               "is taken once, at the node itself",
                                               node)});
      const auto& primitives = model_.meshes[static_cast<std::size_t>(mesh)].primitives;
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        const int mode = primitives[p].mode;
        if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
            mode != TINYGLTF_MODE_TRIANGLE_FAN)
          continue;
        APPLIQUE_TRY(ModelPart part, read_part(node, static_cast<std::size_t>(mesh), p));
        triangles_ += part.triangles.size();
        if (triangles_ > max_triangles)
          return fail(ErrorCode::model_unsupported,
                      fmt::format("'{}': its scene shows more than {} triangles; reduce it", document_.name,
                                  max_triangles));
        if (!part.triangles.empty()) parts.push_back(std::move(part));
      }
    }
    add_normals(parts);
    if (parts.empty())
      return fail(
          ErrorCode::model_invalid,
          fmt::format("'{}': its default scene shows no triangles, and points and lines cannot carry a decal",
                      document_.name));
    return parts;
  }

 private:
  /// The nodes of the default scene in depth-first order: scene "scene", else the first, else every root.
  void list_shown_nodes() {
    const std::size_t count = model_.nodes.size();
    std::vector<std::size_t> stack;
    if (count_of(document_, "scenes") != 0) {
      const std::size_t scene = index_of(document_.json, "scene").value_or(0);
      if (const auto* nodes = find(document_.json["scenes"][scene], {"nodes"}))
        for (auto node = nodes->rbegin(); node != nodes->rend(); ++node)
          stack.push_back(node->get<std::size_t>());
    } else {
      std::vector<char> has_parent(count, 0);
      for (const auto& node : model_.nodes)
        for (const int child : node.children) has_parent[static_cast<std::size_t>(child)] = 1;
      for (std::size_t i = count; i-- > 0;)
        if (has_parent[i] == 0) stack.push_back(i);
    }
    std::vector<char> seen(count, 0);
    while (!stack.empty()) {
      const std::size_t node = stack.back();
      stack.pop_back();
      if (std::exchange(seen[node], 1) == 0) shown_.push_back(node);
      const auto& children = model_.nodes[node].children;
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        stack.push_back(static_cast<std::size_t>(*child));
    }
  }

  /// Parts of one node follow each other.
  static void add_normals(std::vector<ModelPart>& parts) {
    for (std::size_t first = 0; first < parts.size();) {
      std::size_t last = first;
      while (last < parts.size() && parts[last].node == parts[first].node) ++last;
      add_smooth_normals(std::span(parts).subspan(first, last - first));
      first = last;
    }
    for (ModelPart& part : parts)
      for (Vec3& normal : part.normals)
        normal = normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
  }

  Result<ModelPart> read_part(std::size_t node, std::size_t mesh, std::size_t primitive) {
    const auto& entry = model_.meshes[mesh].primitives[primitive];
    where_ = fmt::format("'{}', mesh {}, primitive {}", document_.name, mesh, primitive);
    ModelPart part{.node = node,
                   .mesh = mesh,
                   .primitive = primitive,
                   .material = {},
                   .positions = {},
                   .normals = {},
                   .uvs = {},
                   .other_uvs = {},
                   .tangents = {},
                   .triangles = {},
                   .tinted = {},
                   .mirrored = false,
                   .flat = !entry.attributes.contains("NORMAL")};
    part.material = index_of(document_.json["meshes"][mesh]["primitives"][primitive], "material");
    if (!entry.attributes.contains("POSITION")) return part;
    APPLIQUE_TRY(const auto positions, attribute(entry, "POSITION", 3, 0));
    part.positions = to_vectors(positions);
    const std::size_t count = part.positions.size();
    if (entry.attributes.contains("NORMAL")) {
      APPLIQUE_TRY(const auto normals, attribute(entry, "NORMAL", 3, count));
      part.normals = to_vectors(normals);
    }
    if (entry.attributes.contains("TANGENT") && !part.normals.empty()) {
      APPLIQUE_TRY(const auto tangents, attribute(entry, "TANGENT", 4, count));
      for (std::size_t i = 0; i < count; ++i)
        part.tangents.push_back({Vec3(&tangents[4 * i]), tangents[4 * i + 3] < 0 ? -1.0 : 1.0});
    }
    APPLIQUE_CHECK(apply_morph_targets(part, entry));
    APPLIQUE_CHECK(place(part));
    APPLIQUE_CHECK(read_uvs(part, entry));
    read_colours(part, entry);
    APPLIQUE_CHECK(read_triangles(part, entry));
    for (Tangent& tangent : part.tangents) tangent.direction.normalize();
    return part;
  }

  /// A vertex attribute; `count` is the number of vertices, 0 while it is not known.
  Result<std::vector<double>> attribute(const tinygltf::Primitive& entry, const std::string& name,
                                        int components, std::size_t count) const {
    const int accessor = entry.attributes.at(name);
    APPLIQUE_TRY(auto values,
                 read_accessor(model_, accessor, components, fmt::format("{}, {}", where_, name)));
    APPLIQUE_CHECK(check_count(values.size() / static_cast<std::size_t>(components), count, name));
    return values;
  }

  Result<void> check_count(std::size_t found, std::size_t expected, const std::string& name) const {
    if (expected == 0 || found == expected) return {};
    return fail(ErrorCode::model_invalid,
                fmt::format("{}: {} has {} elements, POSITION has {}", where_, name, found, expected));
  }

  Result<void> apply_morph_targets(ModelPart& part, const tinygltf::Primitive& entry) const {
    const PartKey key = {part.node, part.mesh, part.primitive};
    const auto& weights = rest_weights(model_, key);
    for (std::size_t t = 0; t < std::min(weights.size(), entry.targets.size()); ++t) {
      if (weights[t] == 0) continue;
      APPLIQUE_TRY(const MorphTarget target, read_morph_target(document_, model_, key, t));
      for (std::size_t i = 0; i < target.positions.size(); ++i)
        part.positions[i] += weights[t] * target.positions[i];
      if (part.normals.empty()) continue;
      for (std::size_t i = 0; i < target.normals.size(); ++i)
        part.normals[i] += weights[t] * target.normals[i];
    }
    return {};
  }

  /// Carries positions and normals into the scene: by the skin's joints, or by the node.
  Result<void> place(ModelPart& part) const {
    const Matrix4d& world = world_[part.node];
    part.mirrored = world.topLeftCorner<3, 3>().determinant() < 0;
    APPLIQUE_TRY(const auto skin,
                 read_skinning(document_, model_, world_, {part.node, part.mesh, part.primitive}));
    const auto move = [&](std::size_t i, const Matrix4d& matrix, const Eigen::Matrix3d& normals) {
      part.positions[i] = (matrix * part.positions[i].homogeneous()).head<3>();
      if (!part.normals.empty()) part.normals[i] = normals * part.normals[i];
      if (!part.tangents.empty())
        part.tangents[i].direction = matrix.topLeftCorner<3, 3>() * part.tangents[i].direction;
    };
    const Eigen::Matrix3d world_normals = normal_matrix(world);
    for (std::size_t i = 0; i < part.positions.size(); ++i) {
      const auto joints = skin ? blend_joints(*skin, skin->of_vertex(i)) : std::nullopt;
      if (joints)
        move(i, *joints, normal_matrix(*joints));
      else  // A vertex without weights stays with its node.
        move(i, world, world_normals);
    }
    return {};
  }

  Result<void> read_uvs(ModelPart& part, const tinygltf::Primitive& entry) {
    UvMapping mapping;
    if (part.material) {
      const auto& material = document_.json["materials"][*part.material];
      mapping = read_uv_mapping(material);
      for (const TextureSlots& slots : find_texture_slots(material)) {
        const UvMapping& other = slots.mapping;
        if (other == mapping || part.other_uvs.contains(other.set)) continue;
        APPLIQUE_TRY(auto uvs, uv_set(part, entry, other.set));
        if (!uvs.empty()) part.other_uvs[other.set] = std::move(uvs);
      }
    }
    APPLIQUE_TRY(part.uvs, uv_set(part, entry, mapping.set));
    for (auto& uv : part.uvs) uv = mapping.apply(uv);
    return {};
  }

  /// Colours matter for a warning only: those that cannot be read are left out.
  void read_colours(ModelPart& part, const tinygltf::Primitive& entry) const {
    const auto colours = entry.attributes.find("COLOR_0");
    if (colours == entry.attributes.end()) return;
    const auto& accessor = model_.accessors[static_cast<std::size_t>(colours->second)];
    const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    const auto values = read_accessor(model_, colours->second, components, where_);
    const auto width = static_cast<std::size_t>(components);
    if (!values || width < 3 || values->size() != width * part.positions.size()) return;
    const auto is_tinted = [&](const double* colour) {
      return std::any_of(colour, colour + 3, [](double x) { return x < 1; });
    };
    for (std::size_t i = 0; i < part.positions.size(); ++i)
      part.tinted.push_back(is_tinted(&(*values)[i * width]) ? 1 : 0);
  }

  /// TEXCOORD_n as stored; empty where the primitive has none.
  Result<std::vector<std::array<double, 2>>> uv_set(const ModelPart& part, const tinygltf::Primitive& entry,
                                                    std::size_t set) {
    const std::string name = fmt::format("TEXCOORD_{}", set);
    std::vector<std::array<double, 2>> uvs;
    if (!entry.attributes.contains(name)) return uvs;
    APPLIQUE_TRY(const auto values, attribute(entry, name, 2, part.positions.size()));
    uvs.resize(part.positions.size());
    for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = {values[2 * i], values[2 * i + 1]};
    return uvs;
  }

  Result<void> read_triangles(ModelPart& part, const tinygltf::Primitive& entry) {
    std::vector<std::uint32_t> corners(part.positions.size());
    if (entry.indices >= 0) {
      APPLIQUE_TRY(corners, read_integers(model_, entry.indices, 1, where_ + ", indices"));
      const auto largest = std::max_element(corners.begin(), corners.end());
      if (largest != corners.end() && *largest >= part.positions.size())
        return fail(ErrorCode::model_invalid,
                    fmt::format("{}: index {} of {} vertices", where_, *largest, part.positions.size()));
    } else {
      for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
    }
    if (entry.mode == TINYGLTF_MODE_TRIANGLES) {
      for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        part.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    } else {
      // §3.7.2.1 of the specification.
      const bool strip = entry.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
      for (std::size_t i = 0; i + 2 < corners.size(); ++i)
        part.triangles.push_back(
            strip ? std::array<std::uint32_t, 3>{corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]}
                  : std::array<std::uint32_t, 3>{corners[i + 1], corners[i + 2], corners[0]});
    }
    if (part.mirrored)
      for (auto& t : part.triangles) std::swap(t[1], t[2]);
    return {};
  }

  const Document& document_;
  const tinygltf::Model& model_;
  std::vector<Warning>& warnings_;
  std::vector<Matrix4d> world_;
  std::vector<std::size_t> shown_;
  std::size_t triangles_ = 0;
  std::string where_;
};

bool allowed(const std::vector<std::size_t>& list, std::optional<std::size_t> item) {
  return list.empty() || (item && std::find(list.begin(), list.end(), *item) != list.end());
}

}  // namespace

Vec3 shading_normal(const ModelPart& part, std::size_t triangle, std::size_t corner) {
  const auto& t = part.triangles[triangle];
  if (!part.flat) return part.normals[t[corner]];
  const Vec3 &p = part.positions[t[0]], &q = part.positions[t[1]], &r = part.positions[t[2]];
  const Vec3 normal = (q - p).cross(r - p);
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : part.normals[t[corner]];
}

std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::unordered_map<std::array<double, 3>, Vec3, PositionHash> sums;
  const auto key = [&](std::size_t i) {
    const Vec3& p = positions[i];
    return std::array<double, 3>{p.x(), p.y(), p.z()};
  };
  for (const auto& t : triangles) {
    const Vec3 normal = (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]);
    for (const std::uint32_t corner : t) sums.try_emplace(key(corner), Vec3::Zero()).first->second += normal;
  }
  std::vector<Vec3> normals(positions.size(), Vec3::UnitZ());
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (const auto sum = sums.find(key(i)); sum != sums.end()) normals[i] = sum->second;
  return normals;
}

Result<Model> decode_model(Document document) {
  APPLIQUE_CHECK(check_document(document));
  Model model;
  {
    APPLIQUE_TRY(const Buffers buffers, read_buffers(document));
    APPLIQUE_TRY(const tinygltf::Model geometry, decode_geometry(document, buffers));
    APPLIQUE_TRY(model.parts, PartReader(document, geometry, model.warnings).run());
  }
  for (std::size_t i = 0; i < count_of(document, "materials"); ++i)
    model.materials.push_back(read_material(document, document.json["materials"][i]));
  model.lower = model.upper = model.parts.front().positions.front();
  for (const ModelPart& part : model.parts)
    for (const auto& triangle : part.triangles)
      for (const std::uint32_t corner : triangle) {
        model.lower = model.lower.cwiseMin(part.positions[corner]);
        model.upper = model.upper.cwiseMax(part.positions[corner]);
      }
  if (model.diagonal() == 0)
    return fail(ErrorCode::model_invalid,
                fmt::format("'{}': all its triangles are one point", document.name));
  if (!(model.diagonal() < 1e100))
    return fail(ErrorCode::model_invalid,
                fmt::format("'{}': its node transforms carry it beyond all bounds", document.name));
  model.document = std::move(document);
  return model;
}

Result<Model> load_model(const std::filesystem::path& path) {
  APPLIQUE_TRY(Document document, load_document(path));
  APPLIQUE_TRY(Model model, decode_model(std::move(document)));
  std::set<std::filesystem::path> missing;
  for (std::size_t i = 0; i < count_of(model.document, "images"); ++i)
    if (const auto file = missing_file(model.document, i)) missing.insert(file->lexically_normal());
  for (const auto& file : missing)
    model.warnings.push_back(
        {"file_missing", fmt::format("'{}', which '{}' names, is not there; what is written names it all the "
                                     "same",
                                     file.string(), model.document.name)});
  return model;
}

Result<Image> load_model_image(const Model& model, std::size_t image) {
  return load_document_image(model.document, image);
}

Result<Image> load_document_image(const Document& document, std::size_t image) {
  APPLIQUE_TRY(const auto bytes, read_image_bytes(document, image));
  return decode_image(bytes, fmt::format("{}, image {}", document.name, image));
}

namespace {

/// The size that a KTX2 or DDS says it has: two numbers in its header.
std::optional<std::array<int, 2>> container_size(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t largest = 1 << 16;
  const auto begins = [&](std::string_view magic) {
    return bytes.size() >= 28 &&
           std::equal(magic.begin(), magic.end(), bytes.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
  };
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[at + i];
    return value;
  };
  std::array<std::uint32_t, 2> size = {0, 0};
  if (begins("\xabKTX 20\xbb")) size = {number(20), number(24)};
  if (begins("DDS ")) size = {number(16), number(12)};
  if (size[0] < 1 || size[1] < 1 || std::max(size[0], size[1]) > largest) return std::nullopt;
  return std::array{static_cast<int>(size[0]), static_cast<int>(size[1])};
}

}  // namespace

Result<std::array<int, 2>> document_image_size(const Document& document, std::size_t image) {
  APPLIQUE_TRY(const auto bytes, read_image_bytes(document, image));
  if (const auto size = container_size(bytes)) return *size;
  return image_size(bytes, fmt::format("{}, image {}", document.name, image));
}

ModelSurface build_surface(const Model& model, const std::vector<std::size_t>& nodes,
                           const std::vector<std::size_t>& materials) {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  ModelSurface surface;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const ModelPart& part = model.parts[p];
    if (!allowed(nodes, part.node) || !allowed(materials, part.material)) continue;
    const auto base = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), part.positions.begin(), part.positions.end());
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      const auto& corners = part.triangles[t];
      triangles.push_back({base + corners[0], base + corners[1], base + corners[2]});
      surface.sources.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(t)});
    }
  }
  surface.mesh = weld_surface(positions, triangles);
  return surface;
}

std::array<Texel, 3> texels_inside(const std::array<Texel, 3>& triangle, const FaceCorners& corners) {
  std::array<Texel, 3> inside = {};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 2; ++c)
      inside[k][c] = blend(corners[k], [&](std::size_t i) { return triangle[i][c]; });
  return inside;
}

ModelSurface divided_surface(const ModelSurface& surface, const DividedSurface& divided) {
  return {divided.mesh, surface.sources, divided.corners};
}

}  // namespace applique
