#include "applique/image/decal_image.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "applique/image/coverage.h"
#include "applique/region/region.h"

namespace applique {
namespace {

using Texel = std::array<float, 4>;

/// Calls `rows(first, last)` for bands of rows, on several threads where there is enough to do.
template <class Rows>
void for_rows(std::uint32_t width, std::uint32_t height, const Rows& rows) {
  constexpr std::uint64_t texels_a_thread = 100000;
  const std::uint64_t worth = std::uint64_t{width} * height / texels_a_thread;
  const auto count = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(worth, 1, std::max(1U, std::thread::hardware_concurrency())));
  const auto band = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(std::uint64_t{height} * i / count);
  };
  std::vector<std::jthread> threads;
  for (std::uint32_t i = 1; i < count; ++i) threads.emplace_back([&, i] { rows(band(i), band(i + 1)); });
  rows(0, band(1));
}

const std::vector<float>& data_table() {
  static const std::vector<float> table = [] {
    std::vector<float> values(65536);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) / 65535.0F;
    return values;
  }();
  return table;
}

const std::vector<float>& linear_table() {
  static const std::vector<float> table = [] {
    std::vector<float> values(65536);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 65535));
    }
    return values;
  }();
  return table;
}

void fill_base(const Image& image, const Region& region, const std::vector<float>& linear, Texel* texels) {
  constexpr std::uint32_t rows_at_once = 32;  // Few enough for their coverage to stay in the cache.
  for_rows(image.width, image.height, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t top = first; top < last; top += rows_at_once) {
      const std::uint32_t bottom = std::min(top + rows_at_once, last);
      const std::vector<float> coverage =
          polygon_coverage(region.contour(), image.width, static_cast<int>(top), static_cast<int>(bottom));
      const std::uint16_t* in = image.pixel(0, static_cast<int>(top));
      Texel* out = texels + static_cast<std::size_t>(top) * image.width;
      for (std::size_t i = 0; i < coverage.size(); ++i, in += 4) {
        const float alpha = coverage[i] * static_cast<float>(in[3]) / 65535.0F;
        if (alpha > 0) out[i] = {linear[in[0]] * alpha, linear[in[1]] * alpha, linear[in[2]] * alpha, alpha};
      }
    }
  });
}

/// Means of 2 x 2 texels; what the last row or column lacks is transparent.
void halve(const Texel* in, const DecalImage::Level& fine, const DecalImage::Level& coarse, Texel* out) {
  for_rows(fine.width, coarse.height, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t y = first; y < last; ++y) {
      const Texel* above = in + std::size_t{2} * y * fine.width;
      const Texel* below = 2 * y + 1 < fine.height ? above + fine.width : nullptr;
      for (std::uint32_t x = 0; x < coarse.width; ++x) {
        const std::size_t left = std::size_t{2} * x;
        const bool pair = left + 1 < fine.width;
        Texel& mean = out[std::size_t{y} * coarse.width + x];
        for (std::size_t k = 0; k < 4; ++k) {
          float sum = above[left][k];
          if (pair) sum += above[left + 1][k];
          if (below) sum += below[left][k];
          if (below && pair) sum += below[left + 1][k];
          mean[k] = 0.25F * sum;
        }
      }
    }
  });
}

}  // namespace

double srgb_to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double linear_to_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

DecalImage make_decal_image(const Image& image, const Region& region, bool linear) {
  DecalImage decal;
  decal.frame = region.frame();
  DecalImage::Level level = {0, static_cast<std::uint32_t>(image.width),
                             static_cast<std::uint32_t>(image.height)};
  decal.levels.push_back(level);
  while (level.width > 1 || level.height > 1) {
    level = {level.offset + level.width * level.height, (level.width + 1) / 2, (level.height + 1) / 2};
    decal.levels.push_back(level);
  }
  decal.texels.resize(std::size_t{level.offset} + 1);
  fill_base(image, region, linear ? data_table() : linear_table(), decal.texels.data());
  for (std::size_t k = 1; k < decal.levels.size(); ++k) {
    halve(&decal.texels[decal.levels[k - 1].offset], decal.levels[k - 1], decal.levels[k],
          &decal.texels[decal.levels[k].offset]);
  }
  return decal;
}

}  // namespace applique
