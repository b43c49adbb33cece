#include "gpu/synthetic_transfer.h"

#include <algorithm>
#include <cmath>

namespace applique {
namespace {

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

// Varies along the plane, from some of the groups to others; often none for some.
std::vector<double> influence_at(Vec2 place, int sheet, int groups) {
  std::vector<double> influence;
  double sum = 0;
  for (int g = 0; g < groups; ++g) {
    const double angle = 6.28318530717959 * g / groups + 2 * place.real() + place.imag() + sheet;
    influence.push_back(std::max(0.0, 0.5 + std::cos(angle)));
    sum += influence.back();
  }
  for (double& value : influence) value /= sum;
  return influence;
}

}  // namespace

Warp random_warp(std::mt19937& random, int features, int groups) {
  Warp warp;
  warp.steps = 4;
  warp.features = static_cast<std::uint32_t>(features);
  warp.groups = static_cast<std::uint32_t>(groups);
  for (int k = 0; k < features && groups > 1; ++k)
    warp.group.push_back(static_cast<std::uint32_t>(k % groups));
  std::vector<Vec2> from, to;
  for (int k = 0; k < features; ++k) {
    const double angle = 2 * 3.14159265358979 * k / features, radius = uniform(random, 0.3, 0.7);
    from.push_back(std::polar(radius, angle));
    to.push_back(from.back() + Vec2{uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1)});
    for (int i = 0; i < k; ++i)
      warp.pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k)});
  }
  for (std::uint32_t stage = 0; stage < 3 * warp.steps; ++stage) {
    const std::uint32_t step = stage / 3;
    const double t = (step + 0.5 * (stage % 3)) / warp.steps;
    for (std::uint32_t k = 0; k < warp.features; ++k)
      warp.position.push_back(from[k] + t * (to[k] - from[k]));
    for (const auto& [i, j] : warp.pairs) {
      const Vec2 edge = (1 - t) * (from[j] - from[i]) + t * (to[j] - to[i]);
      const Vec2 lambda = ((to[j] - to[i]) - (from[j] - from[i])) / edge;
      warp.lambda.push_back(lambda);
      warp.offset.push_back(to[i] - from[i] - lambda * (from[i] + t * (to[i] - from[i])));
    }
  }
  return warp;
}

DecalImage noise_image(std::mt19937& random, int width, int height) {
  DecalImage image;
  image.frame = {static_cast<double>(width), static_cast<double>(height)};
  image.levels.push_back({0, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width - 0.5, v = (y + 0.5) / height - 0.5;
      const double alpha = std::clamp(10 * (0.45 - std::hypot(u, v)), 0.0, 1.0);
      const double red = 0.5 + 0.5 * std::sin(40 * u), green = uniform(random, 0, 1), blue = 0.5 + v;
      image.texels.push_back({static_cast<float>(alpha * red), static_cast<float>(alpha * green),
                              static_cast<float>(alpha * blue), static_cast<float>(alpha)});
    }
  }
  while (image.levels.back().width > 1 || image.levels.back().height > 1) {
    const DecalImage::Level finer = image.levels.back();
    const DecalImage::Level level{static_cast<std::uint32_t>(image.texels.size()), (finer.width + 1) / 2,
                                  (finer.height + 1) / 2};
    for (std::uint32_t y = 0; y < level.height; ++y) {
      for (std::uint32_t x = 0; x < level.width; ++x) {
        std::array<float, 4> mean{};
        for (std::uint32_t k = 0; k < 4; ++k) {
          const std::uint32_t fx = 2 * x + k % 2, fy = 2 * y + k / 2;
          if (fx >= finer.width || fy >= finer.height) continue;
          for (int c = 0; c < 4; ++c)
            mean[c] += 0.25F * image.texels[finer.offset + fy * finer.width + fx][c];
        }
        image.texels.push_back(mean);
      }
    }
    image.levels.push_back(level);
  }
  return image;
}

SyntheticTransfer synthetic_transfer(unsigned seed, const SyntheticOptions& options) {
  std::mt19937 random(seed);
  SyntheticTransfer result;
  result.image = std::make_unique<DecalImage>(noise_image(random, options.image, options.image * 3 / 4));
  result.warp = std::make_unique<Warp>(random_warp(random, options.features, options.groups));
  Transfer& transfer = result.transfer;
  transfer.image = result.image.get();
  transfer.warp = result.warp.get();
  const int n = options.grid;
  std::vector<Vec2> texels;
  Vec2 turn;
  for (int sheet = 0; sheet < options.sheets; ++sheet) {
    const bool own_texels = sheet == 0 || !options.stacked;
    const Vec2 about = std::polar(1.0, uniform(random, 0, 6.28));
    if (own_texels) {
      turn = about;
      texels.clear();
    }
    std::vector<Vec2> plane;
    std::vector<std::vector<double>> influence;
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) {
        const Vec2 jitter{uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3)};
        const Vec2 place = (Vec2(x, y) + jitter) * (2.0 / n) - Vec2(1, 1);
        plane.push_back(0.9 * place + Vec2(uniform(random, -0.02, 0.02), 0));
        if (!own_texels) plane.back() *= about;
        influence.push_back(influence_at(place, sheet, options.groups));
        if (!own_texels) continue;
        texels.push_back(static_cast<double>(options.texture) *
                         (0.5 * options.extent * turn * place + Vec2(options.centre, options.centre)));
      }
    }
    for (int y = 0; y < n; ++y) {
      for (int x = own_texels ? 0 : n / 4; x < n; ++x) {
        const int corner = y * (n + 1) + x;
        const Vec2 apart = x >= n / 2 ? turn * Vec2(9.3, 2.1) : Vec2(0, 0);
        for (const std::array<int, 3>& triangle : {std::array<int, 3>{corner, corner + 1, corner + n + 2},
                                                   {corner, corner + n + 2, corner + n + 1}}) {
          TransferFace face;
          for (int k = 0; k < 3; ++k) {
            const Vec2 texel = texels[triangle[k]] + apart;
            face.texel[k] = {texel.real(), texel.imag()};
            face.plane[k] = plane[triangle[k]];
            const std::vector<double>& at = influence[triangle[k]];
            face.image[k] = (*transfer.warp)(face.plane[k], at);
            if (options.groups > 1) transfer.influence.insert(transfer.influence.end(), at.begin(), at.end());
          }
          face.linear = uniform(random, 0, 1) >= options.nonlinear;
          face.sheet = static_cast<std::uint32_t>(sheet);
          transfer.faces.push_back(face);
        }
      }
    }
  }
  return result;
}

Image noise_texture(unsigned seed, int width, int height, int bits) {
  std::mt19937 random(seed);
  Image image;
  image.width = width;
  image.height = height;
  image.bits = bits;
  for (int i = 0; i < 4 * width * height; ++i) {
    image.rgba.push_back(static_cast<std::uint16_t>(bits == 8 ? (random() & 255) * 257 : random() & 65535));
  }
  return image;
}

}  // namespace applique
