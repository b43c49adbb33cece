#include "uv_coverage.h"

#include <algorithm>

#include "uv_raster.h"

namespace applique {

UvCoverage::UvCoverage(int width, int height, WrapMode wrap_u, WrapMode wrap_v)
    : width_(width),
      height_(height),
      wrap_u_(wrap_u),
      wrap_v_(wrap_v),
      counts_(static_cast<std::size_t>(width) * height, 0) {}

bool UvCoverage::place(const Triangle& uvs, std::array<Texel, 3>& texels) const {
  // One triangle over many repeats of the texture covers all of it more than once.
  constexpr double many = 16;
  for (std::size_t k = 0; k < 3; ++k) texels[k] = {uvs[k][0] * width_, uvs[k][1] * height_};
  for (std::size_t c = 0; c < 2; ++c) {
    const auto [lowest, highest] = std::minmax({uvs[0][c], uvs[1][c], uvs[2][c]});
    if (!(highest - lowest < many)) return false;
  }
  return true;
}

std::size_t UvCoverage::index(std::int64_t x, std::int64_t y) const {
  return static_cast<std::size_t>(wrap_texel(y, height_, wrap_v_)) * static_cast<std::size_t>(width_) +
         static_cast<std::size_t>(wrap_texel(x, width_, wrap_u_));
}

void UvCoverage::add(const Triangle& uvs) {
  std::array<Texel, 3> texels = {};
  if (!place(uvs, texels)) {
    std::fill(counts_.begin(), counts_.end(), std::uint8_t{2});
    return;
  }
  for_each_texel(texels, [&](std::int64_t x, std::int64_t y) {
    std::uint8_t& count = counts_[index(x, y)];
    if (count < 2) ++count;
  });
}

UvCoverage::Count UvCoverage::under(const Triangle& uvs) const {
  std::array<Texel, 3> texels = {};
  if (!place(uvs, texels)) return {counts_.size(), counts_.size()};
  Count count;
  for_each_texel(texels, [&](std::int64_t x, std::int64_t y) {
    ++count.covered;
    count.shared += counts_[index(x, y)] > 1 ? 1 : 0;
  });
  return count;
}

double UvCoverage::covered() const {
  const auto empty = std::count(counts_.begin(), counts_.end(), std::uint8_t{0});
  return 1 - static_cast<double>(empty) / static_cast<double>(counts_.size());
}

double UvCoverage::shared() const {
  const auto empty = std::count(counts_.begin(), counts_.end(), std::uint8_t{0});
  const auto shared = std::count(counts_.begin(), counts_.end(), std::uint8_t{2});
  const auto covered = static_cast<std::ptrdiff_t>(counts_.size()) - empty;
  return covered == 0 ? 0 : static_cast<double>(shared) / static_cast<double>(covered);
}

}  // namespace applique
