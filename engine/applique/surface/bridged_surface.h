#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "applique/surface/surface_mesh.h"

namespace applique {

/// A surface on which small holes can be bridged while a patch grows over them: a view of the mesh plus faces
/// of its own, a fan round the hole's centre (§2.7 of the design). Bridge faces carry no texture. The mesh is
/// not changed and must outlive the view; cost follows the bridges.
class BridgedSurface {
 public:
  explicit BridgedSurface(const SurfaceMesh& mesh) : mesh_(&mesh) {}

  [[nodiscard]] const SurfaceMesh& mesh() const { return *mesh_; }
  [[nodiscard]] bool is_bridge(FaceId f) const { return f.value >= mesh_->faces.size(); }
  [[nodiscard]] bool is_bridge(VertexId v) const { return v.value >= mesh_->positions.size(); }
  [[nodiscard]] std::size_t bridged_holes() const { return centres_.size(); }

  [[nodiscard]] const std::array<VertexId, 3>& vertices(FaceId f) const {
    return is_bridge(f) ? bridges_[f.value - mesh_->faces.size()].vertices : mesh_->faces[f];
  }
  [[nodiscard]] const Vec3& position(VertexId v) const {
    return is_bridge(v) ? centres_[v.value - mesh_->positions.size()].position : mesh_->positions[v];
  }
  /// The face across edge k; invalid at a boundary.
  [[nodiscard]] FaceId neighbour(FaceId f, int k) const { return side(f, k).face; }
  /// That face's number of the edge.
  [[nodiscard]] int neighbour_edge(FaceId f, int k) const { return side(f, k).edge; }
  /// Number of faces at the vertex.
  [[nodiscard]] std::uint32_t degree(VertexId v) const;

  /// A boundary loop of the surface, as the sides of the faces along it.
  struct Side {
    FaceId face;
    int edge = 0;
  };
  struct Hole {
    std::vector<Side> sides;
    double perimeter = 0;  ///< Scene units.
  };
  /// The boundary loop through edge k of f, or nothing when it has more than `max_sides` sides.
  [[nodiscard]] std::optional<Hole> hole_at(FaceId f, int k, std::size_t max_sides) const;
  /// Closes the hole with a fan round its centre.
  void bridge(const Hole& hole);

 private:
  struct Bridge {
    std::array<VertexId, 3> vertices;  ///< Corner 0 is the hole's centre, edge 0 lies on the hole's rim.
    std::array<Side, 3> across;
  };
  struct Centre {
    Vec3 position;
    std::uint32_t degree;
  };

  [[nodiscard]] Side side(FaceId f, int k) const;

  const SurfaceMesh* mesh_;
  std::vector<Bridge> bridges_;
  std::vector<Centre> centres_;
  std::unordered_map<std::uint64_t, Side> rim_;  // (face, edge) of the mesh -> the bridge face across
  std::unordered_map<VertexId, std::uint32_t> rim_degree_;
};

}  // namespace applique
