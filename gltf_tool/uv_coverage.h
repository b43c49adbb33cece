#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/transfer/transfer.h"

namespace applique {

/// Counts how many UV triangles cover each texel of a texture, or of a sample of it.
class UvCoverage {
 public:
  UvCoverage(int width, int height, WrapMode wrap_u, WrapMode wrap_v);
  UvCoverage(int size, WrapMode wrap_u, WrapMode wrap_v) : UvCoverage(size, size, wrap_u, wrap_v) {}

  /// A triangle in [0,1] texture space before wrapping.
  using Triangle = std::array<std::array<double, 2>, 3>;

  /// Adds a triangle. Texel centres on a side shared by two triangles count for one of them.
  void add(const Triangle& uvs);

  [[nodiscard]] double covered() const;  ///< Share of the texels under at least one triangle.
  [[nodiscard]] double shared() const;   ///< Share of the covered texels under more than one.

  struct Count {
    std::uint64_t covered = 0;  ///< Texels whose centre the triangle covers.
    std::uint64_t shared = 0;   ///< Those of them under more than one triangle.
  };
  /// What lies under a triangle that was added.
  [[nodiscard]] Count under(const Triangle& uvs) const;

 private:
  /// In texels; false if the triangle covers so many repeats of the texture that it need not be drawn.
  [[nodiscard]] bool place(const Triangle& uvs, std::array<Texel, 3>& texels) const;
  [[nodiscard]] std::size_t index(std::int64_t x, std::int64_t y) const;

  int width_, height_;
  WrapMode wrap_u_, wrap_v_;
  std::vector<std::uint8_t> counts_;  ///< Saturates at 2.
};

}  // namespace applique
