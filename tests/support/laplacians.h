#pragma once

#include <cstddef>
#include <functional>

#include <Eigen/SparseCore>

#include "support/shapes.h"

namespace applique::laplacians {

/// The lower triangle of a soup's cotangent Laplacian, each triangle counting `weight` times, without the
/// vertices that are held. At least one is.
Eigen::SparseMatrix<double> cotangent(
    const shapes::Soup& soup, const std::function<bool(const Vec3&)>& held,
    const std::function<double(std::size_t triangle)>& weight = [](std::size_t) { return 1.0; });

}  // namespace applique::laplacians
