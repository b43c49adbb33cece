#pragma once

#include <functional>
#include <vector>

#include "applique/base/error.h"

#include "mesh.h"

namespace applique::assets {

/// Names the chart that a triangle belongs to, by its centre and normal: any small number.
using ChartRule = std::function<int(const Vec3& centre, const Vec3& normal)>;

/// Texels a unit of length that a chart, named by the rule, gets relative to the others.
using ChartDensity = std::function<double(int chart)>;

/// Charts of one mesh. Each is a topological disc.
struct Charts {
  std::vector<int> of_triangle;
  std::vector<int> name;  ///< The rule's number for each chart.
};

/// Applies the rule, straightens the borders by majority, and gives crumbs to the neighbours they touch most.
Charts segment(const Mesh& mesh, const ChartRule& rule);

/// Unwraps every chart with little distortion, scales it by its density, and packs all into a square of
/// `size` texels, at least `gutter` texels apart (see flatten() and pack()). Vertices on
/// chart borders are duplicated. Fails when a chart is no disc or folds.
Result<Mesh> unwrap(const Mesh& mesh, const Charts& charts, const ChartDensity& density, int size,
                    int gutter);

}  // namespace applique::assets
