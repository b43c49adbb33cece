#include "models/reference_bake.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <vector>

#include "applique/base/parallel.h"

namespace applique {
namespace {

constexpr int samples_a_side = 8;

using Colour = std::array<double, 4>;

Colour level_zero(const DecalImage& image, Pixel pixel) {
  const DecalImage::Level& level = image.levels[0];
  const double x = pixel.x - 0.5, y = pixel.y - 0.5, x0 = std::floor(x), y0 = std::floor(y);
  Colour sum{};
  for (int k = 0; k < 4; ++k) {
    const double px = x0 + k % 2, py = y0 + k / 2;
    if (px < 0 || py < 0 || px >= level.width || py >= level.height) continue;
    const double weight = (k % 2 == 1 ? x - x0 : x0 + 1 - x) * (k / 2 == 1 ? y - y0 : y0 + 1 - y);
    const auto& texel =
        image.texels[static_cast<std::size_t>(py) * level.width + static_cast<std::size_t>(px)];
    for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * texel[c];
  }
  return sum;
}

std::array<double, 3> barycentric(const TransferFace& face, const Texel& p) {
  const auto& t = face.texel;
  const auto area = [](const Texel& a, const Texel& b, const Texel& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  };
  const double whole = area(t[0], t[1], t[2]);
  return {area(p, t[1], t[2]) / whole, area(t[0], p, t[2]) / whole, area(t[0], t[1], p) / whole};
}

Pixel image_point(const Transfer& transfer, const TransferFace& face, const std::array<double, 3>& at) {
  Vec2 plane = 0, image = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    plane += at[k] * face.plane[k];
    image += at[k] * face.image[k];
  }
  const bool warped = transfer.warp != nullptr && transfer.warp->steps > 0;
  return transfer.image->frame.to_pixel(warped ? (*transfer.warp)(plane) : image);
}

/// The faces over each texel.
using FacesByTexel = std::unordered_map<std::uint64_t, std::vector<std::uint32_t>>;

std::uint64_t key_of(std::uint32_t x, std::uint32_t y) {
  return std::uint64_t{y} << 32 | x;
}

FacesByTexel faces_by_texel(const Transfer& transfer) {
  FacesByTexel faces;
  for (std::uint32_t f = 0; f < transfer.faces.size(); ++f) {
    const auto& t = transfer.faces[f].texel;
    const auto [x0, x1] = std::minmax({t[0][0], t[1][0], t[2][0]});
    const auto [y0, y1] = std::minmax({t[0][1], t[1][1], t[2][1]});
    for (auto y = std::max(0.0, std::floor(y0)); y <= y1; ++y)
      for (auto x = std::max(0.0, std::floor(x0)); x <= x1; ++x)
        faces[key_of(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))].push_back(f);
  }
  return faces;
}

/// Whether faces lie over one another there: the texel cannot show both.
bool is_shared(const Transfer& transfer, const std::vector<std::uint32_t>& candidates, const Texel& p) {
  return std::count_if(candidates.begin(), candidates.end(), [&](std::uint32_t f) {
           const auto b = barycentric(transfer.faces[f], p);
           return std::min({b[0], b[1], b[2]}) > 1e-9;
         }) > 1;
}

/// The face that holds the point, or that it is least outside of.
Colour sample_at(const Transfer& transfer, const std::vector<std::uint32_t>& candidates, const Texel& p) {
  double most = -1e300;
  std::uint32_t face = candidates.front();
  std::array<double, 3> at{};
  for (const std::uint32_t f : candidates) {
    const auto b = barycentric(transfer.faces[f], p);
    const double inside = std::min({b[0], b[1], b[2]});
    if (!(inside > most)) continue;
    most = inside;
    face = f;
    at = b;
  }
  return level_zero(*transfer.image, image_point(transfer, transfer.faces[face], at));
}

}  // namespace

BakeQuality compare_with_samples(const Transfer& transfer, const Image& before, const Image& baked,
                                 const TransferResult& covered, std::size_t stride) {
  const FacesByTexel faces = faces_by_texel(transfer);
  const std::size_t count = covered.samples.size() / stride;
  std::vector<std::optional<std::array<double, 3>>> differences(count);
  parallel_for(static_cast<int>(count), [&](int i) {
    const auto& texel = covered.samples[static_cast<std::size_t>(i) * stride];
    const auto candidates = faces.find(key_of(texel.x, texel.y));
    if (candidates == faces.end() || is_shared(transfer, candidates->second, {texel.x + 0.5, texel.y + 0.5}))
      return;
    Colour mean{};
    for (int k = 0; k < samples_a_side * samples_a_side; ++k) {
      const Texel p = {texel.x + (k % samples_a_side + 0.5) / samples_a_side,
                       texel.y + (k / samples_a_side + 0.5) / samples_a_side};
      const Colour colour = sample_at(transfer, candidates->second, p);
      for (std::size_t c = 0; c < 4; ++c)
        mean[c] += transfer.opacity * colour[c] / (samples_a_side * samples_a_side);
    }
    const std::uint16_t* below = before.pixel(static_cast<int>(texel.x), static_cast<int>(texel.y));
    const std::uint16_t* found = baked.pixel(static_cast<int>(texel.x), static_cast<int>(texel.y));
    auto& difference = differences[static_cast<std::size_t>(i)].emplace();
    for (std::size_t c = 0; c < 3; ++c) {
      const double under = srgb_to_linear(below[c] / 65535.0);
      const double expected = linear_to_srgb(std::clamp(mean[c] + (1 - mean[3]) * under, 0.0, 1.0));
      difference[c] = 255 * (found[c] / 65535.0 - expected);
    }
  });
  BakeQuality quality;
  double squares = 0;
  for (const auto& difference : differences) {
    if (!difference) continue;
    ++quality.texels;
    for (const double d : *difference) {
      squares += d * d;
      quality.largest = std::max(quality.largest, std::abs(d));
    }
  }
  quality.psnr = 10 * std::log10(255 * 255 / (squares / (3 * static_cast<double>(quality.texels))));
  return quality;
}

}  // namespace applique
