#pragma once

#include "mesh.h"

namespace applique::assets {

/// Where the label goes: the body is a cylinder about the y axis here.
constexpr double bottle_radius = 0.5;
constexpr double bottle_label_low = 0.28;
constexpr double bottle_label_high = 1.72;

/// What lies higher is cork.
constexpr double bottle_cork_height = 3.06;

/// A corked bottle as a surface of revolution about the y axis, standing on y = 0. Its vertices are doubled
/// along the half plane x = 0, z > 0: the seam that the label is stuck across.
Mesh bottle_mesh();

/// Body, shoulder, neck and foot as charts.
int bottle_chart(const Vec3& centre, const Vec3& normal);

/// Texels a unit of length that a chart gets, relative to the others: most on the body, for the label.
double bottle_chart_density(int chart);

/// The point of the body at `along` around from the seam (scene units, towards +x) and height `y`.
Vec3 bottle_point(double along, double y);

}  // namespace applique::assets
