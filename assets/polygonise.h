#pragma once

#include <functional>

#include "mesh.h"

namespace applique::assets {

/// A signed distance function, negative inside.
using DistanceField = std::function<double(const Vec3&)>;

struct PolygoniseOptions {
  Vec3 low;  ///< The box that holds the surface.
  Vec3 high;
  Vec3 focus;           ///< Where triangles are smallest.
  double focus_radius;  ///< Within it, edges are about `fine` long,
  double fine;          ///< growing to `coarse` far away.
  double coarse;
  int smoothing = 8;  ///< Rounds of tangential smoothing.
};

/// The zero surface of `field` as a 2-manifold with well-shaped triangles: dual contouring on a grid that is
/// bent to be finer near the focus (one vertex for each sheet of the surface in a cell, as in S. Schaefer, T.
/// Ju, J. Warren, "Manifold Dual Contouring", 2007), vertices moved onto the surface, tangential smoothing
/// between. Normals are the field's gradient.
Mesh polygonise(const DistanceField& field, const PolygoniseOptions& options);

/// The unit gradient of `field` by finite differences.
Vec3 field_normal(const DistanceField& field, const Vec3& p);

/// How open the surface is to the sky at `p`: 1 open, towards 0 in cavities; from the field along the normal
/// up to `reach` away.
double openness(const DistanceField& field, const Vec3& p, const Vec3& normal, double reach);

/// Moves `p` along the gradient until |field| < tolerance.
Vec3 project_to_surface(const DistanceField& field, Vec3 p, double tolerance = 1e-7);

}  // namespace applique::assets
