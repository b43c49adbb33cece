#pragma once

#include <memory>
#include <optional>

#include "applique/surface/surface_mesh.h"

namespace applique {

/// Nearest-point and ray queries on a surface: a bounding-volume hierarchy over its faces, of which each
/// query builds what it comes by: O(n) for the first, O(log n) for one near an earlier one. Not for several
/// threads at once. The mesh must outlive it.
class SurfaceQuery {
 public:
  explicit SurfaceQuery(const SurfaceMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  /// The surface point nearest to `position`; ties go to the lowest face. The mesh has at least one face.
  [[nodiscard]] SurfacePoint nearest(const Vec3& position) const;
  /// The first hit of the ray from `origin` along `direction` (any length > 0), from either side; none if it
  /// misses.
  [[nodiscard]] std::optional<SurfacePoint> first_hit(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Tree;
  const SurfaceMesh* mesh_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace applique
