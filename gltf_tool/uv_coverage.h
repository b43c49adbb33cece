#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/transfer/transfer.h"

namespace applique {

/// Counts how many UV triangles cover each texel of a square sample of a texture.
class UvCoverage {
 public:
  explicit UvCoverage(int size, WrapMode wrap_u, WrapMode wrap_v);

  /// Adds a triangle, given in [0,1] texture space before wrapping. Texel centres on a side shared by two
  /// triangles count for one of them.
  void add(const std::array<std::array<double, 2>, 3>& uvs);

  [[nodiscard]] double covered() const;  ///< Share of the texels under at least one triangle.
  [[nodiscard]] double shared() const;   ///< Share of the covered texels under more than one.

 private:
  [[nodiscard]] int wrap(std::int64_t texel, WrapMode mode) const;

  int size_;
  WrapMode wrap_u_, wrap_v_;
  std::vector<std::uint8_t> counts_;  ///< Saturates at 2.
};

}  // namespace applique
