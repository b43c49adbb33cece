#pragma once

#include "polygonise.h"

namespace applique::assets {

struct RemeshOptions {
  std::function<double(const Vec3&)> finest;  ///< Shortest target edge length at a place.
  double coarsest;                            ///< Longest target edge length.
  /// Target edge length on a curve of radius 1: edges are `fineness` times the smallest radius of curvature.
  double fineness;
  /// How fast edges may grow along the surface.
  double grading = 0.3;
  int rounds = 6;
};

/// Makes the triangles of a closed manifold near-equilateral, with edges that follow the curvature of
/// `field`'s zero surface: rounds of splits, collapses, flips towards valence 6 and tangential smoothing,
/// each vertex put back onto the surface. After M. Botsch, L. Kobbelt, "A Remeshing Approach to
/// Multiresolution Modeling", 2004. Collapses and flips keep the mesh manifold (link condition). Recomputes
/// the normals from the field.
Mesh remesh(const Mesh& mesh, const DistanceField& field, const RemeshOptions& options);

}  // namespace applique::assets
