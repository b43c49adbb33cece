#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "applique/patch/patch.h"
#include "applique/surface/bridged_surface.h"

namespace applique {

/// A patch while it grows: an immersed triangulated disc with three primitives that keep it a disc on any
/// manifold surface (§2.1, §2.4, §2.5 of the design). They replace the paper's insertion cases, merging and
/// rollback (§5.2): attaching a triangle along one edge keeps a disc; identifying two consecutive boundary
/// edges does when the boundary is longer than that; nothing else is ever identified, so two fronts that meet
/// head-on stay distinct.
///
/// Invariants, checked by `broken_invariant`: V - E + F = 1 with one boundary loop of length >= 3; neighbours
/// are mutual and agree with the surface; each vertex has a single fan over distinct surface faces, at most
/// as many as there are at the surface vertex; no surface face is covered more often than the count says.
///
/// Removed faces and merged vertices leave dead ids behind until `compact`.
class ImmersedDisc {
 public:
  /// The disc of one face. The surface must outlive the disc.
  ImmersedDisc(BridgedSurface& surface, FaceId first);

  enum class Glue {
    glued,
    boundary,  ///< The surface ends here.
    covered,   ///< The next surface face has been covered as often as allowed.
    wrapped,   ///< The fan round an end of the edge already goes all the way round.
    closed,    ///< The disc would close to a sphere.
  };
  struct GlueResult {
    Glue outcome;
    PatchFaceId face;      ///< The new face, when glued.
    PatchVertexId vertex;  ///< Its apex; may have been merged with an older vertex.
    bool merged = false;   ///< The apex was merged with an older vertex.
  };
  /// Adds the surface face across boundary edge k of q, unless it is covered `cover_limit` times, and zips.
  GlueResult glue(PatchFaceId q, int k, std::uint32_t cover_limit);

  /// Glues faces round vertex v until its fan is closed or nothing more can be glued. Returns v, or the
  /// vertex that it was merged into.
  PatchVertexId complete_fan(PatchVertexId v, std::uint32_t cover_limit);
  /// With a limit for each surface face.
  PatchVertexId complete_fan(PatchVertexId v, const std::function<std::uint32_t(FaceId)>& cover_limit);

  /// A boundary edge at v, as the face and the edge to glue across; nothing when v is interior.
  struct Side {
    PatchFaceId face;
    int edge = 0;
  };
  [[nodiscard]] std::optional<Side> open_side(PatchVertexId v) const;

  /// Whether removing q keeps the disc: an ear (two boundary edges), or one boundary edge and an interior
  /// vertex opposite. Pinned faces are not removable.
  [[nodiscard]] bool removable(PatchFaceId q) const;
  /// Removes a removable face.
  void remove(PatchFaceId q);

  /// Joins consecutive boundary edges over one surface edge wherever that keeps the disc: what removing faces
  /// has brought into contact.
  void close_slits();

  /// Keeps q from being removed.
  void pin(PatchFaceId q) { pinned_[q] = true; }
  [[nodiscard]] bool pinned(PatchFaceId q) const { return pinned_[q]; }

  /// Drops dead ids and renumbers; returns the new id of each old one (invalid for the dead).
  struct Renumbering {
    IdVector<PatchFaceId, PatchFaceId> faces;
    IdVector<PatchVertexId, PatchVertexId> vertices;
  };
  Renumbering compact();

  [[nodiscard]] const BridgedSurface& surface() const { return *surface_; }
  BridgedSurface& surface() { return *surface_; }
  /// Faces and vertices by id, dead ones included. `mesh_face` may be a bridge of the surface.
  [[nodiscard]] const IdVector<PatchFaceId, PatchFace>& faces() const { return faces_; }
  [[nodiscard]] std::size_t vertex_count() const { return vertices_.size(); }
  [[nodiscard]] bool alive(PatchFaceId q) const { return faces_[q].vertices[0].valid(); }
  [[nodiscard]] bool alive(PatchVertexId v) const { return vertices_[v].face.valid(); }
  [[nodiscard]] VertexId mesh_vertex(PatchVertexId v) const { return vertices_[v].mesh_vertex; }
  [[nodiscard]] const Vec3& position(PatchVertexId v) const { return surface_->position(mesh_vertex(v)); }
  /// The vertex that v has been merged into, or v itself.
  [[nodiscard]] PatchVertexId survivor(PatchVertexId v) const;
  [[nodiscard]] std::size_t live_faces() const { return live_faces_; }
  [[nodiscard]] std::size_t boundary_length() const { return boundary_length_; }
  /// How many patch faces lie over f.
  [[nodiscard]] std::uint32_t cover(FaceId f) const;
  [[nodiscard]] bool on_boundary(PatchVertexId v) const;
  /// The faces round v, counter-clockwise; from the boundary when v lies on it.
  [[nodiscard]] std::vector<PatchFaceId> fan(PatchVertexId v) const;
  [[nodiscard]] int corner(PatchFaceId q, PatchVertexId v) const;
  /// The neighbour of v over a surface vertex, or v itself if it lies over it; invalid when there is none.
  [[nodiscard]] PatchVertexId neighbour_over(PatchVertexId v, VertexId target) const;

  /// What is wrong, or an empty string. O(size); for tests and debug builds.
  [[nodiscard]] std::string broken_invariant() const;

 private:
  struct Vertex {
    VertexId mesh_vertex;
    PatchFaceId face;           ///< One live face at the vertex; invalid when dead.
    std::uint32_t fan = 0;      ///< Number of live faces at the vertex.
    PatchVertexId merged_into;  ///< For dead vertices that were merged.
  };

  [[nodiscard]] bool full(PatchVertexId v) const {
    return vertices_[v].fan == surface_->degree(vertices_[v].mesh_vertex);
  }
  [[nodiscard]] Side outgoing_boundary(PatchVertexId v) const;  ///< Invalid face when v is interior.
  [[nodiscard]] Side incoming_boundary(PatchVertexId v) const;
  [[nodiscard]] int back_edge(PatchFaceId q, int k) const;
  void zip(PatchVertexId v);
  void merge(PatchVertexId from, PatchVertexId into);

  BridgedSurface* surface_;
  IdVector<PatchFaceId, PatchFace> faces_;
  IdVector<PatchFaceId, char> pinned_;
  IdVector<PatchVertexId, Vertex> vertices_;
  std::unordered_map<FaceId, std::uint32_t> cover_;
  std::size_t live_faces_ = 0;
  std::size_t boundary_length_ = 0;
};

}  // namespace applique
