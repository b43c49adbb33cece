#pragma once

#include <array>

#include "applique/base/types.h"
#include "applique/image/image.h"

#include "model.h"

namespace applique {

/// How the base colours of two models differ, as bilinear filtering shows them.
struct LookDifference {
  std::size_t triangles = 0;  ///< Of the second model, compared.
  std::size_t missing = 0;    ///< Of them, not in the first model.
  double largest = 0;         ///< Over points inside the triangles, in steps of 1/255.
};

/// Compares every triangle of `after` with the one of `before` that has its corners; of several, with the
/// most alike.
LookDifference compare_looks(const Model& before, const Model& after);

/// The base colour at the place of the model's surface nearest to `position`, stored values / 257.
std::array<double, 4> colour_near(const Model& model, const Vec3& position);

}  // namespace applique
