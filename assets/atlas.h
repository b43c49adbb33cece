#pragma once

#include <functional>
#include <vector>

#include "applique/base/error.h"

#include "mesh.h"

namespace applique::assets {

/// Names the chart that a triangle belongs to, by its centre and normal: any small number.
using ChartRule = std::function<int(const Vec3& centre, const Vec3& normal)>;

/// Charts of one mesh. Each is a topological disc.
struct Charts {
  std::vector<int> of_triangle;
  int count = 0;
};

/// Applies the rule, straightens the borders by majority, and gives crumbs to the neighbours they touch most.
Charts segment(const Mesh& mesh, const ChartRule& rule);

/// Unwraps every chart with little distortion (Tutte's embedding, then as-rigid-as-possible, L. Liu et al.,
/// "A Local/Global Approach to Mesh Parameterization", 2008), turns each into its smallest box, and packs
/// them at one scale into a square of `size` texels, at least `gutter` texels apart and from the sides.
/// Vertices on chart borders are duplicated. Fails when a chart is no disc or folds.
Result<Mesh> unwrap(const Mesh& mesh, const Charts& charts, int size, int gutter);

}  // namespace applique::assets
