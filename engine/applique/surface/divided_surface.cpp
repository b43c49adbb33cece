#include "applique/surface/divided_surface.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include <Eigen/LU>

namespace applique {
namespace {

Eigen::Matrix3d columns(const FaceCorners& corners) {
  Eigen::Matrix3d m;
  for (int k = 0; k < 3; ++k) m.col(k) = Eigen::Map<const Vec3>(corners[k].data());
  return m;
}

struct LongestEdge {
  int k;
  double squared_length;
};

LongestEdge longest_edge(const SurfaceMesh& mesh, FaceId f) {
  const auto p = mesh.corners(f);
  LongestEdge longest = {0, -1};
  for (int k = 0; k < 3; ++k) {
    const double squared = (p[(k + 2) % 3] - p[(k + 1) % 3]).squaredNorm();
    if (squared > longest.squared_length) longest = {k, squared};
  }
  return longest;
}

std::vector<Vec3> positions_of(const SurfaceMesh& mesh, std::span<const SurfacePoint> places) {
  std::vector<Vec3> positions;
  for (const SurfacePoint& place : places) positions.push_back(position_of(mesh, place));
  return positions;
}

/// Whether the face has an edge that is too long, and any of the places may be within reach of it.
bool is_to_be_cut(const SurfaceMesh& mesh, FaceId f, const std::vector<Vec3>& places,
                  const Division& division) {
  if (longest_edge(mesh, f).squared_length <= division.longest_edge * division.longest_edge) return false;
  const auto p = mesh.corners(f);
  const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
  double radius = 0;
  for (const Vec3& corner : p) radius = std::max(radius, (corner - middle).norm());
  return std::any_of(places.begin(), places.end(),
                     [&](const Vec3& place) { return (place - middle).norm() <= division.reach + radius; });
}

class Divider {
 public:
  Divider(const SurfaceMesh& mesh, std::span<const SurfacePoint> places, const Division& division)
      : division_(division), places_(positions_of(mesh, places)) {
    out_.mesh = mesh;
    const auto all = ids<FaceId>(mesh.faces.size());
    out_.whole.reserve(mesh.faces.size());
    for (const FaceId f : all) out_.whole.push_back(f);
    out_.corners.resize(mesh.faces.size(), whole_face);
  }

  DividedSurface run() {
    const std::size_t most = out_.mesh.faces.size() + division_.parts;
    for (const FaceId f : ids<FaceId>(out_.mesh.faces.size())) consider(f);
    while (!queue_.empty() && out_.mesh.faces.size() < most) {
      const auto [length, f] = queue_.top();
      queue_.pop();
      if (length == longest_edge(out_.mesh, f).squared_length) bisect(f);
    }
    return std::move(out_);
  }

 private:
  void consider(FaceId f) {
    if (is_to_be_cut(out_.mesh, f, places_, division_))
      queue_.push({longest_edge(out_.mesh, f).squared_length, f});
  }

  /// Cuts the longest edge of f, and before it what is longer in the face beyond.
  void bisect(FaceId f) {
    while (true) {
      const LongestEdge edge = longest_edge(out_.mesh, f);
      const FaceId beyond = out_.mesh.neighbours[f][edge.k];
      if (!beyond.valid() || longest_edge(out_.mesh, beyond).squared_length <= edge.squared_length) {
        cut(f, edge.k);
        return;
      }
      bisect(beyond);
    }
  }

  void cut(FaceId f, int k) {
    SurfaceMesh& mesh = out_.mesh;
    const VertexId b = mesh.faces[f][(k + 1) % 3], c = mesh.faces[f][(k + 2) % 3];
    const VertexId middle = mesh.positions.push_back((mesh.positions[b] + mesh.positions[c]) / 2);
    mesh.component.push_back(std::uint32_t(mesh.component[b]));
    mesh.vertex_face.push_back(f);
    mesh.degree.push_back(0);
    const FaceId g = mesh.neighbours[f][k];
    const int j = mesh.neighbour_edges[f][k];
    const FaceId f_part = cut_face(f, k, middle);
    std::vector<FaceId> changed = {f, f_part};
    if (g.valid()) {
      const FaceId g_part = cut_face(g, j, middle);
      join(f, k, g_part, j);
      join(f_part, k, g, j);
      changed.insert(changed.end(), {g, g_part});
    }
    for (const FaceId face : changed) consider(face);
  }

  /// Cuts a face (a, b, c), a its corner k, into itself, (a, b, middle), and the new (a, middle, c), but for
  /// what is beyond edge k.
  FaceId cut_face(FaceId f, int k, VertexId middle) {
    SurfaceMesh& mesh = out_.mesh;
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    const FaceId part = mesh.faces.push_back(std::array<VertexId, 3>(mesh.faces[f]));
    mesh.neighbours.push_back({});
    mesh.neighbour_edges.push_back({});
    mesh.source.push_back(std::uint32_t(mesh.source[f]));
    out_.whole.push_back(FaceId(out_.whole[f]));
    out_.corners.push_back(FaceCorners(out_.corners[f]));
    mesh.faces[f][last] = mesh.faces[part][next] = middle;
    std::array<double, 3> between = {};
    for (int i = 0; i < 3; ++i) between[i] = (out_.corners[f][next][i] + out_.corners[f][last][i]) / 2;
    out_.corners[f][last] = out_.corners[part][next] = between;

    join(part, next, mesh.neighbours[f][next], mesh.neighbour_edges[f][next]);
    join(f, next, part, last);
    mesh.degree[mesh.faces[f][k]] += 1;
    mesh.degree[middle] += 2;
    mesh.vertex_face[mesh.faces[part][last]] = part;
    return part;
  }

  /// Makes edge i of f and edge j of g one; g may be none.
  void join(FaceId f, int i, FaceId g, int j) {
    SurfaceMesh& mesh = out_.mesh;
    mesh.neighbours[f][i] = g;
    mesh.neighbour_edges[f][i] = static_cast<std::uint8_t>(j);
    if (!g.valid()) return;
    mesh.neighbours[g][j] = f;
    mesh.neighbour_edges[g][j] = static_cast<std::uint8_t>(i);
  }

  Division division_;
  std::vector<Vec3> places_;
  DividedSurface out_;
  std::priority_queue<std::pair<double, FaceId>> queue_;  ///< Squared length of the longest edge, and face.
};

}  // namespace

SurfacePoint DividedSurface::to_part(const SurfacePoint& point) const {
  const Vec3 at = Eigen::Map<const Vec3>(point.barycentric.data());
  SurfacePoint best;
  double deepest = -std::numeric_limits<double>::infinity();
  const auto consider = [&](FaceId f) {
    const Vec3 weights = columns(corners[f]).inverse() * at;
    if (weights.minCoeff() <= deepest) return;
    deepest = weights.minCoeff();
    best = {f, {weights[0], weights[1], weights[2]}};
  };
  consider(point.face);  // Which is a part of itself; the others come after all whole faces.
  for (std::size_t f = whole.size(); f-- > 0 && whole[FaceId(f)] != FaceId(f);)
    if (whole[FaceId(f)] == point.face) consider(FaceId(f));
  double sum = 0;
  for (double& weight : best.barycentric) sum += weight = std::max(weight, 0.0);
  for (double& weight : best.barycentric) weight /= sum;
  return best;
}

SurfacePoint DividedSurface::to_whole(const SurfacePoint& point) const {
  const Vec3 weights = columns(corners[point.face]) * Eigen::Map<const Vec3>(point.barycentric.data());
  return {whole[point.face], {weights[0], weights[1], weights[2]}};
}

bool would_divide(const SurfaceMesh& mesh, std::span<const SurfacePoint> places, const Division& division) {
  const std::vector<Vec3> positions = positions_of(mesh, places);
  const auto faces = ids<FaceId>(mesh.faces.size());
  for (const FaceId f : faces)
    if (is_to_be_cut(mesh, f, positions, division)) return true;
  return false;
}

DividedSurface divide_surface(const SurfaceMesh& mesh, std::span<const SurfacePoint> places,
                              const Division& division) {
  return Divider(mesh, places, division).run();
}

}  // namespace applique
