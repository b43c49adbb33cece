#include "overlay_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace applique {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using Origin = DecalMesh::Origin;

/// A part of a patch face.
struct Triangle {
  Corners corners = {};
  PatchFaceId face;

  std::uint32_t operator[](std::size_t k) const { return corners[k]; }
};

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_between(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The place t of the way from a to b, within a face that has both.
Origin origin_between(const Origin& a, const Origin& b, double t) {
  Origin origin = a;
  for (double& weight : origin.weights) weight *= 1 - t;
  for (std::size_t k = 0; k < 3; ++k) {
    if (b.weights[k] == 0) continue;
    std::size_t slot = 0;
    while (slot < 3 && (origin.weights[slot] == 0 || origin.vertices[slot] != b.vertices[k])) ++slot;
    for (std::size_t free = 0; slot == 3; ++free)
      if (origin.weights[free] == 0) slot = free;
    origin.vertices[slot] = b.vertices[k];
    origin.weights[slot] += t * b.weights[k];
  }
  return origin;
}

/// The growing mesh; the triangles are linear in the plane.
struct Builder {
  std::vector<Vec3> positions;
  std::vector<Vec3> directions;  ///< In which it is lifted; any length.
  std::vector<Vec2> plane;
  std::vector<Vec2> image;   ///< Plane units.
  std::vector<double> lift;  ///< Above the surface, in offsets.
  std::vector<Origin> origins;
  std::size_t groups = 0;  ///< Of the features; 0 where there is one, whose influence is nobody's concern.
  std::vector<double> influence;    ///< [vertex * groups + group].
  std::vector<Triangle> triangles;  ///< In the order in which they are to be drawn.

  [[nodiscard]] double influence_at(std::uint32_t vertex, std::size_t group) const {
    return influence[vertex * groups + group];
  }

  /// A vertex on an edge, t of the way from a to b; its image is exact only after the caller set it.
  std::uint32_t add_between(std::uint32_t a, std::uint32_t b, double t) {
    positions.emplace_back((1 - t) * positions[a] + t * positions[b]);
    directions.emplace_back((1 - t) * directions[a].normalized() + t * directions[b].normalized());
    plane.push_back((1 - t) * plane[a] + t * plane[b]);
    image.push_back((1 - t) * image[a] + t * image[b]);
    lift.push_back((1 - t) * lift[a] + t * lift[b]);
    origins.push_back(origin_between(origins[a], origins[b], t));
    for (std::size_t g = 0; g < groups; ++g)
      influence.push_back((1 - t) * influence_at(a, g) + t * influence_at(b, g));
    return static_cast<std::uint32_t>(positions.size() - 1);
  }
};

Builder gather_faces(const Model& model, const SolvedDecal& decal) {
  const DecalMap& map = decal.map;
  std::vector<PatchFaceId> shown;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size()))
    if (map.textured[f] != 0 && map.patch.faces[f].mesh_face.valid()) shown.push_back(f);
  std::stable_sort(shown.begin(), shown.end(),
                   [&](PatchFaceId a, PatchFaceId b) { return map.sheet[a] < map.sheet[b]; });
  Builder mesh;
  if (map.groups > 1) mesh.groups = map.groups;
  IdVector<PatchVertexId, std::uint32_t> index(map.patch.vertices.size(), ~0U);
  for (const PatchFaceId f : shown) {
    const PatchFace& face = map.patch.faces[f];
    const auto& source = decal.surface->source(face.mesh_face);
    const ModelPart& part = model.parts[source.part];
    const FaceCorners& inside = decal.surface->corners_in_source(face.mesh_face);
    const auto corners = decal.surface->mesh.corners(face.mesh_face);
    const double area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    Corners triangle = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchVertexId vertex = face.vertices[k];
      if (index[vertex] == ~0U) {
        index[vertex] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(corners[k]);
        mesh.directions.emplace_back(Vec3::Zero());
        mesh.plane.push_back(map.plane[vertex]);
        mesh.image.push_back(map.image[vertex]);
        mesh.lift.push_back(0);
        mesh.origins.push_back({{vertex}, {1, 0, 0}});
        for (std::size_t g = 0; g < mesh.groups; ++g)
          mesh.influence.push_back(map.influence[vertex.value * mesh.groups + g]);
      }
      triangle[k] = index[vertex];
      mesh.lift[triangle[k]] = 1 + map.sheet[f];  // The highest comes last.
      mesh.directions[triangle[k]] += area * blend(inside[k], [&](std::size_t i) -> const Vec3& {
                                        return part.normals[part.triangles[source.triangle][i]];
                                      });
    }
    mesh.triangles.push_back({triangle, f});
  }
  return mesh;
}

/// Divides edges, for both their faces at once, until every triangle is linear to `max_deviation` plane
/// units.
class Divider {
 public:
  Divider(Builder& mesh, const Warp& warp, double max_deviation)
      : mesh_(&mesh), warp_(&warp), max_deviation_(max_deviation) {}

  void run() {
    constexpr int max_rounds = 10;  // halves an edge a thousandfold
    // Where an image is torn, more of them would not mend it.
    const std::size_t most_triangles = std::max<std::size_t>(50'000, 4 * mesh_->triangles.size());
    for (int round = 0; round < max_rounds; ++round) {
      if (mesh_->triangles.size() > most_triangles || is_done()) return;
      std::vector<Triangle> divided;
      for (const Triangle& triangle : mesh_->triangles) divide(triangle, divided);
      mesh_->triangles = std::move(divided);
    }
  }

  /// Whether nothing is to be divided; finds out what is.
  bool is_done() {
    middles_.clear();
    for (const Triangle& triangle : mesh_->triangles) mark(triangle);
    return middles_.empty();
  }

 private:
  [[nodiscard]] bool deviates(const Triangle& t, const std::array<double, 3>& weights) const {
    Vec2 plane = 0;
    Vec2 image = 0;
    std::vector<double> influence(mesh_->groups, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      plane += weights[k] * mesh_->plane[t[k]];
      image += weights[k] * mesh_->image[t[k]];
      for (std::size_t g = 0; g < mesh_->groups; ++g)
        influence[g] += weights[k] * mesh_->influence_at(t[k], g);
    }
    return std::abs((*warp_)(plane, influence) - image) > max_deviation_;
  }

  [[nodiscard]] bool edge_deviates(const Triangle& t, std::size_t a, std::size_t b) const {
    for (const double s : {0.25, 0.5, 0.75}) {
      std::array<double, 3> weights = {0, 0, 0};
      weights[a] = 1 - s;
      weights[b] = s;
      if (deviates(t, weights)) return true;
    }
    return false;
  }

  void mark_edge(std::uint32_t a, std::uint32_t b) {
    const auto [middle, fresh] = middles_.try_emplace(edge_between(a, b));
    if (!fresh) return;
    middle->second = mesh_->add_between(a, b, 0.5);
    mesh_->image.back() = (*warp_)(mesh_->plane.back(), std::span(mesh_->influence).last(mesh_->groups));
  }

  void mark(const Triangle& t) {
    bool marked = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (!edge_deviates(t, k, next)) continue;
      mark_edge(t[k], t[next]);
      marked = true;
    }
    if (marked) return;
    // Linear along its edges, yet not inside: the longest edge goes.
    constexpr std::array<std::array<double, 3>, 4> inside = {
        {{1.0 / 3, 1.0 / 3, 1.0 / 3}, {0.5, 0.25, 0.25}, {0.25, 0.5, 0.25}, {0.25, 0.25, 0.5}}};
    if (std::none_of(inside.begin(), inside.end(), [&](const auto& weights) { return deviates(t, weights); }))
      return;
    std::size_t longest = 0;
    const auto length = [&](std::size_t k) {
      return std::abs(mesh_->plane[t[k]] - mesh_->plane[t[(k + 1) % 3]]);
    };
    for (std::size_t k = 1; k < 3; ++k)
      if (length(k) > length(longest)) longest = k;
    mark_edge(t[longest], t[(longest + 1) % 3]);
  }

  void divide(const Triangle& t, std::vector<Triangle>& out) const {
    std::array<std::uint32_t, 3> middle = {};  // of edge k, from corner k to corner k + 1
    std::array<bool, 3> split = {};
    const auto put = [&](const Corners& corners) { out.push_back({corners, t.face}); };
    int splits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = middles_.find(edge_between(t[k], t[(k + 1) % 3]));
      split[k] = found != middles_.end();
      if (!split[k]) continue;
      middle[k] = found->second;
      ++splits;
    }
    if (splits == 0) {
      out.push_back(t);
    } else if (splits == 3) {
      put({t[0], middle[0], middle[2]});
      put({middle[0], t[1], middle[1]});
      put({middle[2], middle[1], t[2]});
      put(middle);
    } else if (splits == 1) {
      const std::size_t k = split[0] ? 0 : split[1] ? 1 : 2;
      const std::uint32_t apex = t[(k + 2) % 3];
      put({t[k], middle[k], apex});
      put({middle[k], t[(k + 1) % 3], apex});
    } else {
      const std::size_t whole = !split[0] ? 0 : !split[1] ? 1 : 2;  // the edge that stays
      const std::uint32_t a = t[whole];
      const std::uint32_t b = t[(whole + 1) % 3];
      const std::uint32_t c = t[(whole + 2) % 3];
      const std::uint32_t bc = middle[(whole + 1) % 3];
      const std::uint32_t ca = middle[(whole + 2) % 3];
      put({ca, bc, c});
      put({a, b, bc});
      put({a, bc, ca});
    }
  }

  Builder* mesh_;
  const Warp* warp_;
  double max_deviation_;
  std::map<Edge, std::uint32_t> middles_;
};

/// Keeps what lies on the side of one border of the image where `distance` is not negative.
class BorderCut {
 public:
  BorderCut(Builder& mesh, std::vector<double> distance) : mesh_(&mesh), distance_(std::move(distance)) {}

  void run() {
    std::vector<Triangle> kept;
    for (const Triangle& triangle : mesh_->triangles) {
      std::vector<std::uint32_t> polygon;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangle[k];
        const std::uint32_t b = triangle[(k + 1) % 3];
        if (distance_[a] >= 0) polygon.push_back(a);
        if ((distance_[a] > 0 && distance_[b] < 0) || (distance_[a] < 0 && distance_[b] > 0))
          polygon.push_back(crossing(a, b));
      }
      for (std::size_t k = 2; k < polygon.size(); ++k)
        kept.push_back({{polygon[0], polygon[k - 1], polygon[k]}, triangle.face});
    }
    mesh_->triangles = std::move(kept);
  }

 private:
  std::uint32_t crossing(std::uint32_t a, std::uint32_t b) {
    const Edge edge = edge_between(a, b);
    const auto [found, fresh] = crossings_.try_emplace(edge);
    if (fresh) {
      const double from = distance_[edge.first];
      found->second = mesh_->add_between(edge.first, edge.second, from / (from - distance_[edge.second]));
    }
    return found->second;
  }

  Builder* mesh_;
  std::vector<double> distance_;
  std::map<Edge, std::uint32_t> crossings_;
};

void cut_at_image_border(Builder& mesh, const ImageFrame& frame) {
  const double half_width = 0.5 * frame.width / frame.pixels_per_unit();
  const double half_height = 0.5 * frame.height / frame.pixels_per_unit();
  for (const Vec2 inward : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)}) {
    const double extent = inward.imag() == 0 ? half_width : half_height;
    std::vector<double> distance(mesh.image.size());
    for (std::size_t i = 0; i < distance.size(); ++i) {
      distance[i] = extent + dot(inward, mesh.image[i]);
      // Else rounding would leave slivers where the border runs along edges, whose texture has no direction.
      constexpr double nothing = 1e-9;
      if (std::abs(distance[i]) < nothing) distance[i] = 0;
    }
    BorderCut(mesh, std::move(distance)).run();
  }
}

/// A deviation in pixels, less a margin: it is looked for at some points of a triangle only.
double plane_units(const SolvedDecal& decal, double max_deviation) {
  constexpr double margin = 0.8;
  return margin * max_deviation / decal.region.frame().pixels_per_unit();
}

/// Calls visit(weight, i) for the corners of the source triangle under a place in a face, in the origin's
/// order: on whole triangles sums are equal for all faces about it.
template <class Visit>
void for_corners_under(const SolvedDecal& decal, const Origin& origin, PatchFaceId face, const Visit& visit) {
  const PatchFace& patch_face = decal.map.patch.faces[face];
  const FaceCorners& inside = decal.surface->corners_in_source(patch_face.mesh_face);
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        if (origin.weights[j] != 0 && patch_face.vertices[k] == origin.vertices[j] && inside[k][i] != 0)
          visit(origin.weights[j] * inside[k][i], i);
}

/// The normal of the surface under a vertex of a triangle.
Vec3 normal_under(const Model& model, const SolvedDecal& decal, const Origin& origin, PatchFaceId face) {
  const auto& source = decal.surface->source(decal.map.patch.faces[face].mesh_face);
  Vec3 normal = Vec3::Zero();
  for_corners_under(decal, origin, face, [&](double weight, std::size_t i) {
    normal += weight * shading_normal(model.parts[source.part], source.triangle, i);
  });
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::UnitZ());
}

/// Without vertices that no triangle uses, and with one for each normal that the triangles about it have.
class Compactor {
 public:
  Compactor(const Model& model, const SolvedDecal& decal, const Builder& mesh, double offset)
      : model_(&model), decal_(&decal), mesh_(&mesh), offset_(offset) {}

  DecalMesh run() {
    for (const Triangle& triangle : mesh_->triangles) {
      Corners renumbered = {};
      for (std::size_t k = 0; k < 3; ++k) renumbered[k] = vertex_of(triangle[k], triangle.face);
      out_.triangles.push_back(renumbered);
      out_.faces.push_back(triangle.face);
    }
    return std::move(out_);
  }

 private:
  /// Normals that a file would store as the same are.
  using Key = std::pair<std::uint32_t, std::array<float, 3>>;

  std::uint32_t vertex_of(std::uint32_t v, PatchFaceId face) {
    const Vec3 normal = normal_under(*model_, *decal_, mesh_->origins[v], face);
    const Eigen::Vector3f stored = normal.cast<float>();
    const auto [found, fresh] = index_.try_emplace(Key(v, {stored.x(), stored.y(), stored.z()}),
                                                   static_cast<std::uint32_t>(out_.positions.size()));
    if (fresh) add_vertex(v, normal);
    return found->second;
  }

  void add_vertex(std::uint32_t v, const Vec3& normal) {
    const ImageFrame& frame = decal_->region.frame();
    const double length = mesh_->directions[v].norm();
    const Vec3 direction = length > 0 ? Vec3(mesh_->directions[v] / length) : Vec3::UnitZ();
    const Pixel pixel = frame.to_pixel(mesh_->image[v]);
    out_.positions.emplace_back(mesh_->positions[v] + offset_ * mesh_->lift[v] * direction);
    out_.normals.push_back(normal);
    out_.directions.push_back(direction);
    out_.heights.push_back(offset_ * mesh_->lift[v]);
    out_.origins.push_back(mesh_->origins[v]);
    out_.uvs.push_back({pixel.x / frame.width, pixel.y / frame.height});
  }

  const Model* model_;
  const SolvedDecal* decal_;
  const Builder* mesh_;
  double offset_;
  std::map<Key, std::uint32_t> index_;
  DecalMesh out_;
};

}  // namespace

DecalMesh build_overlay_mesh(const Model& model, const SolvedDecal& decal, double offset,
                             double max_deviation) {
  Builder mesh = gather_faces(model, decal);
  Divider(mesh, decal.map.warp, plane_units(decal, max_deviation)).run();
  cut_at_image_border(mesh, decal.region.frame());
  return Compactor(model, decal, mesh, offset).run();
}

std::array<double, 3> weights_in_source(const SolvedDecal& decal, const DecalMesh::Origin& origin,
                                        PatchFaceId face) {
  std::array<double, 3> weights = {0, 0, 0};
  for_corners_under(decal, origin, face, [&](double weight, std::size_t i) { weights[i] += weight; });
  return weights;
}

DecalMesh build_whole_mesh(const Model& model, const SolvedDecal& decal, double offset) {
  return Compactor(model, decal, gather_faces(model, decal), offset).run();
}

bool is_linear(const Model& model, const SolvedDecal& decal, double max_deviation) {
  Builder mesh = gather_faces(model, decal);
  return Divider(mesh, decal.map.warp, plane_units(decal, max_deviation)).is_done();
}

double default_offset(const Model& model) {
  return 0.0005 * model.diagonal();
}

}  // namespace applique
