#include "applique/surface/surface_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <unordered_set>

#include "applique/region/funnel.h"
#include "applique/surface/shortest_path.h"
#include "applique/surface/tangent_frame.h"

namespace applique {
namespace {

constexpr double straight = 1e-9;    // radians: what a turn may lack of half a turn
constexpr double off_vertex = 1e-9;  // of an edge: a traced line keeps this far from vertices

int corner_of(const SurfaceMesh& mesh, FaceId f, VertexId v) {
  const auto& corners = mesh.faces[f];
  return static_cast<int>(std::find(corners.begin(), corners.end(), v) - corners.begin());
}

bool has_corner(const SurfaceMesh& mesh, FaceId f, VertexId v) {
  return corner_of(mesh, f, v) < 3;
}

enum class Way { clockwise, counter_clockwise };

/// The faces round v after `from`, to the first for which `wanted` holds; nothing when the surface's boundary
/// comes first.
template <class Wanted>
std::optional<std::vector<FaceId>> walk_round(const SurfaceMesh& mesh, VertexId v, FaceId from, Way way,
                                              Wanted wanted) {
  std::vector<FaceId> faces;
  for (FaceId f = from; !wanted(f);) {
    f = mesh.neighbours[f][(corner_of(mesh, f, v) + (way == Way::clockwise ? 2 : 1)) % 3];
    if (!f.valid() || f == from) return std::nullopt;
    faces.push_back(f);
  }
  return faces;
}

/// The angle of all faces at a vertex; 0 at the boundary.
double angle_round(const SurfaceMesh& mesh, VertexId v) {
  double angle = 0;
  bool closed = true;
  for_each_face(mesh, v, [&](FaceId f) {
    const int k = corner_of(mesh, f, v);
    const auto corners = mesh.corners(f);
    const Vec3 a = corners[(k + 1) % 3] - corners[k], b = corners[(k + 2) % 3] - corners[k];
    angle += std::atan2(a.cross(b).norm(), a.dot(b));
    closed = closed && mesh.neighbours[f][(k + 1) % 3].valid() && mesh.neighbours[f][(k + 2) % 3].valid();
  });
  return closed ? angle : 0;
}

/// Where the third corner c of a triangle lies in a plane in which a and b are at `at_a` and `at_b`: on the
/// left.
Vec2 unfold(const Vec3& a, const Vec3& b, const Vec3& c, Vec2 at_a, Vec2 at_b) {
  const Vec3 edge = b - a, d = c - a;
  return at_a + (at_b - at_a) * Vec2(d.dot(edge), edge.cross(d).norm()) / edge.squaredNorm();
}

/// A strip of faces, each sharing an edge with the next, and the shortest path in it.
class Sleeve {
 public:
  Sleeve(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to)
      : mesh_(mesh), from_(from), to_(to), faces_{from.face} {}

  /// Lays the strip along a path of vertices. Whether that worked.
  bool lay_along(const std::vector<VertexId>& path) {
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto wanted = [&](FaceId f) {
        return i + 1 < path.size() ? has_corner(mesh_, f, path[i + 1]) : f == to_.face;
      };
      const auto one = walk_round(mesh_, path[i], faces_.back(), Way::clockwise, wanted);
      const auto other = walk_round(mesh_, path[i], faces_.back(), Way::counter_clockwise, wanted);
      if (!one && !other) return false;
      const auto& way = !other || (one && one->size() <= other->size()) ? *one : *other;
      faces_.insert(faces_.end(), way.begin(), way.end());
    }
    drop_detours();
    return !path.empty();
  }

  /// Turns the strip to the other side of vertices until the path is locally shortest.
  void straighten() {
    pull();
    // Each turn makes the path shorter; the bound is for rounding.
    for (std::size_t left = 64 + 16 * faces_.size(); left > 0 && turn_over(); --left) pull();
  }

  [[nodiscard]] SurfaceLine line() const {
    SurfaceLine line{{position_of(mesh_, from_)}, faces_};
    Vec2 piece = start_;
    for (std::size_t i = 0, turn = 0; i < portals_.size(); ++i) {
      while (turn < turns_.size() && turns_[turn].portal < i) piece = turns_[turn++].at;
      const Vec2 next = turn < turns_.size() ? turns_[turn].at : end_;
      const auto [left, right] = portals_[i];
      const double across = cross(right - left, next - piece);
      const double t = across != 0 ? cross(piece - left, next - piece) / across : 0;
      const auto [l, r] = sides_[i];
      line.points.push_back(mesh_.positions[l] +
                            std::clamp(t, 0.0, 1.0) * (mesh_.positions[r] - mesh_.positions[l]));
    }
    line.points.push_back(position_of(mesh_, to_));
    return line;
  }

 private:
  struct Side {
    VertexId left, right;
  };

  /// A strip that goes into a face and comes back need not go there.
  void drop_detours() {
    std::vector<FaceId> kept;
    for (FaceId f : faces_) {
      kept.push_back(f);
      while (kept.size() >= 3 && kept[kept.size() - 1] == kept[kept.size() - 3]) kept.resize(kept.size() - 2);
    }
    faces_ = std::move(kept);
  }

  /// Unfolds the strip into the plane and pulls the path tight in it.
  void pull() {
    portals_.clear();
    sides_.clear();
    std::array<Vec2, 3> at = lay_first();
    start_ = interpolate(at, from_);
    for (std::size_t i = 0; i + 1 < faces_.size(); ++i) {
      const FaceId f = faces_[i], g = faces_[i + 1];
      const auto& neighbours = mesh_.neighbours[f];
      const auto k =
          static_cast<int>(std::find(neighbours.begin(), neighbours.end(), g) - neighbours.begin());
      const Vec2 right = at[(k + 1) % 3], left = at[(k + 2) % 3];
      portals_.push_back({left, right});
      sides_.push_back({mesh_.faces[f][(k + 2) % 3], mesh_.faces[f][(k + 1) % 3]});
      const int e = mesh_.neighbour_edges[f][k];
      const auto corners = mesh_.corners(g);
      at[(e + 1) % 3] = left;
      at[(e + 2) % 3] = right;
      at[e] = unfold(corners[(e + 1) % 3], corners[(e + 2) % 3], corners[e], left, right);
    }
    end_ = interpolate(at, to_);
    turns_ = pull_tight(start_, end_, portals_);
  }

  [[nodiscard]] std::array<Vec2, 3> lay_first() const {
    const auto [a, b, c] = mesh_.corners(faces_.front());
    const Vec2 at_b = (b - a).norm();
    return {0, at_b, unfold(a, b, c, 0, at_b)};
  }

  static Vec2 interpolate(const std::array<Vec2, 3>& at, const SurfacePoint& point) {
    return point.barycentric[0] * at[0] + point.barycentric[1] * at[1] + point.barycentric[2] * at[2];
  }

  /// Takes the strip to the other side of the vertices that the path bends round needlessly, from the last to
  /// the first. Whether there was one.
  bool turn_over() {
    bool turned = false;
    std::size_t free = faces_.size();  // The faces before this one are as they were.
    for (std::size_t i = turns_.size(); i-- > 0;) {
      const FunnelTurn& turn = turns_[i];
      if (turn.portal + 1 >= free) continue;
      const VertexId v = turn.left ? sides_[turn.portal].left : sides_[turn.portal].right;
      std::size_t first = turn.portal, last = turn.portal + 1;
      while (first > 0 && has_corner(mesh_, faces_[first - 1], v)) --first;
      while (last + 1 < faces_.size() && has_corner(mesh_, faces_[last + 1], v)) ++last;
      if (last >= free || !bends_needlessly(i, v)) continue;
      const auto other =
          walk_round(mesh_, v, faces_[first], turn.left ? Way::clockwise : Way::counter_clockwise,
                     [&](FaceId f) { return f == faces_[last]; });
      if (!other) continue;
      const auto at = faces_.erase(faces_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                                   faces_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
      faces_.insert(at, other->begin(), other->end());
      free = first;
      turned = true;
    }
    if (turned) drop_detours();
    return turned;
  }

  /// Whether there is less than half a turn on the far side of the vertex.
  [[nodiscard]] bool bends_needlessly(std::size_t i, VertexId v) const {
    const Vec2 before = i > 0 ? turns_[i - 1].at : start_;
    const Vec2 after = i + 1 < turns_.size() ? turns_[i + 1].at : end_;
    const Vec2 in = turns_[i].at - before, out = after - turns_[i].at;
    const double bend = std::atan2(std::abs(cross(in, out)), dot(in, out));
    const double round = angle_round(mesh_, v);
    return round > 0 && round - (std::numbers::pi + bend) < std::numbers::pi - straight;
  }

  const SurfaceMesh& mesh_;
  SurfacePoint from_, to_;
  std::vector<FaceId> faces_;
  std::vector<Portal> portals_;  ///< portals_[i] from faces_[i] to the next; unfolded, scene units.
  std::vector<Side> sides_;      ///< Their vertices.
  Vec2 start_, end_;
  std::vector<FunnelTurn> turns_;
};

}  // namespace

double SurfaceLine::length() const {
  double length = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) length += (points[i + 1] - points[i]).norm();
  return length;
}

SurfaceLine SurfaceLine::reversed() const {
  return {{points.rbegin(), points.rend()}, {faces.rbegin(), faces.rend()}};
}

void SurfaceLine::append(const SurfaceLine& next) {
  if (next.points.empty()) return;
  if (!points.empty()) points.pop_back();
  points.insert(points.end(), next.points.begin(), next.points.end());
  faces.insert(faces.end(), next.faces.begin(), next.faces.end());
}

SurfaceLine geodesic_between(const SurfaceMesh& mesh, const SurfacePoint& from, const SurfacePoint& to) {
  if (from.face == to.face) return {{position_of(mesh, from), position_of(mesh, to)}, {from.face}};
  Sleeve sleeve(mesh, from, to);
  if (!sleeve.lay_along(shortest_path(mesh, from, to))) return {};
  sleeve.straighten();
  return sleeve.line();
}

SurfaceLine geodesic_from(const SurfaceMesh& mesh, const SurfacePoint& from, const Vec3& direction,
                          double length) {
  SurfaceLine line{{position_of(mesh, from)}, {}};
  FaceId f = from.face;
  Vec3 normal = face_normal(mesh, f);
  Vec3 along = (direction - direction.dot(normal) * normal).normalized();
  std::unordered_set<FaceId> passed;
  while (passed.insert(f).second) {
    const Vec3 start = line.points.back();
    const TangentFrame frame = {start, along, normal.cross(along), normal};
    const auto corners = mesh.corners(f);
    std::array<Vec2, 3> at;
    for (int k = 0; k < 3; ++k) at[k] = frame.coordinates(corners[k]);
    // The way out: the edge that goes from the line's right to its left.
    int k = 0;
    while (k < 3 && !(at[(k + 1) % 3].imag() < 0 && at[(k + 2) % 3].imag() >= 0)) ++k;
    if (k == 3) break;
    const Vec3 a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
    const double right = at[(k + 1) % 3].imag(), left = at[(k + 2) % 3].imag();
    const Vec3 exit = a + std::clamp(right / (right - left), off_vertex, 1 - off_vertex) * (b - a);
    line.faces.push_back(f);
    if (const double step = (exit - start).norm(); step >= length) {
      line.points.emplace_back(start + length * along);
      break;
    } else {
      length -= step;
    }
    line.points.push_back(exit);
    f = mesh.neighbours[f][k];
    if (!f.valid()) break;
    // Straight on in the next face: the same angle with the edge.
    const Vec3 edge = (b - a).normalized();
    normal = face_normal(mesh, f);
    along = (along.dot(edge) * edge + along.cross(edge).norm() * edge.cross(normal)).normalized();
  }
  return line;
}

}  // namespace applique
