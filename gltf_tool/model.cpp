#include "model.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry.h"
#include "material.h"

namespace applique {
namespace {

using Eigen::Matrix4d;

/// A file of a few kilobytes can draw one mesh from very many nodes; more than this is not a model to pin
/// decals on.
constexpr std::size_t max_triangles = std::size_t{1} << 26;

Matrix4d local_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Matrix4d>(node.matrix.data());
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3) transform.translate(Eigen::Map<const Vec3>(node.translation.data()));
  if (node.rotation.size() == 4) {
    const Eigen::Quaterniond q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (q.norm() > 0) transform.rotate(q.normalized());
  }
  if (node.scale.size() == 3) transform.scale(Eigen::Map<const Vec3>(node.scale.data()));
  return transform.matrix();
}

/// The matrix that carries normals: the inverse transpose of the linear part, up to a positive factor.
Eigen::Matrix3d normal_matrix(const Matrix4d& matrix) {
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  Eigen::Matrix3d cofactor;
  for (int c = 0; c < 3; ++c) cofactor.col(c) = linear.col((c + 1) % 3).cross(linear.col((c + 2) % 3));
  return linear.determinant() < 0 ? Eigen::Matrix3d(-cofactor) : cofactor;
}

std::vector<Vec3> to_vectors(const std::vector<double>& values) {
  std::vector<Vec3> vectors(values.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return vectors;
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
    place_nodes();
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
      return fail(ErrorCode::model_invalid,
                  fmt::format("'{}': its default scene shows no triangles", document_.name));
    return parts;
  }

 private:
  /// World matrices of all nodes, and the nodes of the default scene in depth-first order: scene "scene",
  /// else the first, else every root.
  void place_nodes() {
    const std::size_t count = model_.nodes.size();
    world_.assign(count, Matrix4d::Identity());
    std::vector<char> has_parent(count, 0);
    for (const auto& node : model_.nodes)
      for (const int child : node.children) has_parent[static_cast<std::size_t>(child)] = 1;
    std::vector<std::size_t> roots;
    for (std::size_t i = count; i-- > 0;)
      if (has_parent[i] == 0) roots.push_back(i);
    visit(roots, [&](std::size_t node, std::optional<std::size_t> parent) {
      world_[node] = local_matrix(model_.nodes[node]);
      if (parent) world_[node] = world_[*parent] * world_[node];
    });
    if (count_of(document_, "scenes") != 0) {
      roots.clear();
      const std::size_t scene = index_of(document_.json, "scene").value_or(0);
      if (const auto* nodes = find(document_.json["scenes"][scene], {"nodes"}))
        for (auto node = nodes->rbegin(); node != nodes->rend(); ++node)
          roots.push_back(node->get<std::size_t>());
    }
    std::vector<char> seen(count, 0);
    visit(roots, [&](std::size_t node, std::optional<std::size_t>) {
      if (std::exchange(seen[node], 1) == 0) shown_.push_back(node);
    });
  }

  template <class Function>
  void visit(const std::vector<std::size_t>& roots, Function function) const {
    std::vector<std::pair<std::size_t, std::optional<std::size_t>>> stack;
    for (const std::size_t root : roots) stack.emplace_back(root, std::nullopt);
    while (!stack.empty()) {
      const auto [node, parent] = stack.back();
      stack.pop_back();
      function(node, parent);
      const auto& children = model_.nodes[node].children;
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        stack.emplace_back(static_cast<std::size_t>(*child), node);
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
                   .mirrored = false};
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
    APPLIQUE_CHECK(place(part, entry));
    APPLIQUE_CHECK(read_uvs(part, entry));
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

  /// Default weights: the node's, else the mesh's, else none.
  Result<void> apply_morph_targets(ModelPart& part, const tinygltf::Primitive& entry) const {
    const auto& node_weights = model_.nodes[part.node].weights;
    const auto& weights = node_weights.empty() ? model_.meshes[part.mesh].weights : node_weights;
    for (std::size_t t = 0; t < std::min(weights.size(), entry.targets.size()); ++t) {
      if (weights[t] == 0) continue;
      for (const char* name : {"POSITION", "NORMAL"}) {
        auto& vectors = std::string_view(name) == "POSITION" ? part.positions : part.normals;
        const auto target = entry.targets[t].find(name);
        if (target == entry.targets[t].end() || vectors.empty()) continue;
        APPLIQUE_TRY(const auto values,
                     read_accessor(model_, target->second, 3,
                                   fmt::format("{}, morph target {}, {}", where_, t, name)));
        APPLIQUE_CHECK(
            check_count(values.size() / 3, vectors.size(), fmt::format("morph target {}'s {}", t, name)));
        const auto offsets = to_vectors(values);
        for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] += weights[t] * offsets[i];
      }
    }
    return {};
  }

  /// Carries positions and normals into the scene: by the skin's joints, or by the node.
  Result<void> place(ModelPart& part, const tinygltf::Primitive& entry) {
    part.mirrored = world_[part.node].topLeftCorner<3, 3>().determinant() < 0;
    if (model_.nodes[part.node].skin >= 0 && entry.attributes.contains("JOINTS_0") &&
        entry.attributes.contains("WEIGHTS_0"))
      return place_skinned(part, entry);
    const Matrix4d& matrix = world_[part.node];
    for (Vec3& p : part.positions) p = (matrix * p.homogeneous()).head<3>();
    const Eigen::Matrix3d normals = normal_matrix(matrix);
    for (Vec3& n : part.normals) n = normals * n;
    for (Tangent& t : part.tangents) t.direction = matrix.topLeftCorner<3, 3>() * t.direction;
    return {};
  }

  Result<void> place_skinned(ModelPart& part, const tinygltf::Primitive& entry) {
    const auto& skin = model_.skins[static_cast<std::size_t>(model_.nodes[part.node].skin)];
    std::vector<Matrix4d> joints;
    for (const int joint : skin.joints) joints.push_back(world_[static_cast<std::size_t>(joint)]);
    if (skin.inverseBindMatrices >= 0) {
      APPLIQUE_TRY(const auto values,
                   read_accessor(model_, skin.inverseBindMatrices, 16,
                                 fmt::format("'{}', skin {}, inverseBindMatrices", document_.name,
                                             model_.nodes[part.node].skin)));
      if (values.size() / 16 < joints.size())
        return fail(ErrorCode::model_invalid,
                    fmt::format("'{}', skin {}: {} inverse bind matrices for {} joints", document_.name,
                                model_.nodes[part.node].skin, values.size() / 16, joints.size()));
      for (std::size_t j = 0; j < joints.size(); ++j)
        joints[j] *= Eigen::Map<const Matrix4d>(&values[16 * j]);
    }
    const std::size_t count = part.positions.size();
    std::vector<Matrix4d> blend(count, Matrix4d::Zero());
    std::vector<double> sums(count, 0);
    for (int set = 0; entry.attributes.contains(fmt::format("JOINTS_{}", set)) &&
                      entry.attributes.contains(fmt::format("WEIGHTS_{}", set));
         ++set) {
      const std::string joints_name = fmt::format("JOINTS_{}", set);
      APPLIQUE_TRY(const auto indices, read_integers(model_, entry.attributes.at(joints_name), 4,
                                                     fmt::format("{}, {}", where_, joints_name)));
      APPLIQUE_CHECK(check_count(indices.size() / 4, count, joints_name));
      APPLIQUE_TRY(const auto weights, attribute(entry, fmt::format("WEIGHTS_{}", set), 4, count));
      for (std::size_t i = 0; i < 4 * count; ++i) {
        if (weights[i] == 0) continue;
        if (indices[i] >= joints.size())
          return fail(ErrorCode::model_invalid, fmt::format("{}: {} names joint {} of {}", where_,
                                                            joints_name, indices[i], joints.size()));
        blend[i / 4] += weights[i] * joints[indices[i]];
        sums[i / 4] += weights[i];
      }
    }
    // Files round the weights, so their sum is only about 1; a vertex without any stays with its node.
    for (std::size_t i = 0; i < count; ++i) {
      const Matrix4d matrix = sums[i] > 0 ? Matrix4d(blend[i] / sums[i]) : world_[part.node];
      part.positions[i] = (matrix * part.positions[i].homogeneous()).head<3>();
      if (!part.normals.empty()) part.normals[i] = normal_matrix(matrix) * part.normals[i];
      if (!part.tangents.empty())
        part.tangents[i].direction = matrix.topLeftCorner<3, 3>() * part.tangents[i].direction;
    }
    return {};
  }

  Result<void> read_uvs(ModelPart& part, const tinygltf::Primitive& entry) {
    UvMapping mapping;
    if (part.material) {
      const auto& material = document_.json["materials"][*part.material];
      mapping = read_uv_mapping(material);
      for (const MaterialSlot slot : all_slots) {
        const UvMapping other = read_uv_mapping(material, slot);
        if (other == mapping || part.other_uvs.contains(other.set)) continue;
        APPLIQUE_TRY(auto uvs, uv_set(part, entry, other.set));
        if (!uvs.empty()) part.other_uvs[other.set] = std::move(uvs);
      }
    }
    APPLIQUE_TRY(part.uvs, uv_set(part, entry, mapping.set));
    for (auto& uv : part.uvs) uv = mapping.apply(uv);
    return {};
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
  std::vector<Matrix4d, Eigen::aligned_allocator<Matrix4d>> world_;
  std::vector<std::size_t> shown_;
  std::size_t triangles_ = 0;
  std::string where_;
};

bool allowed(const std::vector<std::size_t>& list, std::optional<std::size_t> item) {
  return list.empty() || (item && std::find(list.begin(), list.end(), *item) != list.end());
}

}  // namespace

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
  return decode_model(std::move(document));
}

Result<Image> load_model_image(const Model& model, std::size_t image) {
  return load_document_image(model.document, image);
}

Result<Image> load_document_image(const Document& document, std::size_t image) {
  APPLIQUE_TRY(const auto bytes, read_image_bytes(document, image));
  return decode_image(bytes, fmt::format("'{}', image {}", document.name, image));
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

}  // namespace applique
