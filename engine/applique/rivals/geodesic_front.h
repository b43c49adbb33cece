#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <unordered_map>
#include <vector>

#include "applique/rivals/rival_map.h"

namespace applique {

/// Geodesic coordinates carried over the surface's vertices in the order of Dijkstra's distances along edges,
/// from those that have coordinates to begin with: the discrete exponential map (Schmidt et al. 2006), of a
/// point or of a line. A vertex r takes from a neighbour q that was settled before the coordinates
///
///     u_q + the edge q -> r projected on q's tangent plane, at the edge's length, in q's axes.
///
/// Its axes are those of the start that q descends from, turned by the smallest rotation from the normal
/// there to the normal at q, as in the paper: parallel transport on spheres and cylinders, near it elsewhere.
/// Normals are weighted by area.
class GeodesicFront {
 public:
  /// From coordinates to the image.
  using ToImage = std::function<Vec2(Vec2)>;

  GeodesicFront(const SurfaceMesh& surface, Parents parents) : surface_(surface), parents_(parents) {}

  /// A vertex to begin with: its coordinates and the direction of the first axis, a tangent vector where the
  /// unit normal is `normal`. `distance` from the origin or line, scene units; the nearest start counts.
  void start(VertexId v, double distance, Vec2 at, const Vec3& axis, const Vec3& normal);

  /// Goes on, everywhere, until the corners of these points' faces are settled. They are connected with a
  /// start.
  void reach(const std::vector<Feature>& features);
  /// Where a point comes to whose face's corners are settled. The map is linear in each face.
  [[nodiscard]] Vec2 image_of(const SurfacePoint& point, const ToImage& to_image) const;
  /// Goes on over all that meets the box, and a ring beyond.
  RivalMap cover(const RegionBox& box, const ToImage& to_image);

 private:
  /// The axes that a start lends to all that descends from it.
  struct Axes {
    Vec3 axis, normal;
  };
  struct Vertex {
    double distance = std::numeric_limits<double>::infinity();
    VertexId parent;  ///< Invalid at a start.
    std::size_t axes = 0;
    Vec2 at = 0;
    Vec3 axis = Vec3::Zero(), normal = Vec3::Zero();  ///< Of its own, once it is settled.
    bool settled = false, expanded = false;
  };
  struct Candidate {
    double distance;
    VertexId vertex;
    bool operator>(const Candidate& other) const {
      return std::tie(distance, vertex) > std::tie(other.distance, other.vertex);
    }
  };

  [[nodiscard]] bool settled(VertexId v) const;
  std::optional<VertexId> settle();
  void expand(VertexId v);
  void take_coordinates(VertexId r, Vertex& vertex);

  const SurfaceMesh& surface_;
  Parents parents_;
  std::vector<Axes> axes_;
  std::unordered_map<VertexId, Vertex> vertices_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  std::vector<VertexId> order_;  ///< As settled.
};

}  // namespace applique
