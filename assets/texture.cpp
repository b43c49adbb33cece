#include "texture.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace applique::assets {
namespace {

std::uint32_t hash(std::int32_t x, std::int32_t y, std::int32_t z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343U ^
                    static_cast<std::uint32_t>(y) * 0xd8163841U ^ static_cast<std::uint32_t>(z) * 0xcb1ab31fU;
  h ^= h >> 15;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12;
  h *= 0x297a2d39U;
  return h ^ h >> 15;
}

/// The dot product of a lattice point's gradient (an edge midpoint of a cube) with the offset from it.
double gradient(const Eigen::Vector3i& cell, const Vec3& offset) {
  const std::uint32_t h = hash(cell.x(), cell.y(), cell.z());
  const double a = h & 1 ? 1 : -1;
  const double b = h & 2 ? 1 : -1;
  switch ((h >> 2) % 3) {
    case 0:
      return a * offset.x() + b * offset.y();
    case 1:
      return a * offset.y() + b * offset.z();
    default:
      return a * offset.z() + b * offset.x();
  }
}

/// A texel's place on the mesh.
struct Covered {
  std::int32_t triangle = -1;
  float b1 = 0;
  float b2 = 0;
};

std::vector<Covered> rasterise(const Mesh& mesh, int size) {
  std::vector<Covered> map(static_cast<std::size_t>(size) * size);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d a = size * mesh.uvs[mesh.triangles[t][0]];
    const Eigen::Vector2d ab = size * mesh.uvs[mesh.triangles[t][1]] - a;
    const Eigen::Vector2d ac = size * mesh.uvs[mesh.triangles[t][2]] - a;
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area == 0) continue;
    const Eigen::Vector2d low = a + Eigen::Vector2d::Zero().cwiseMin(ab).cwiseMin(ac);
    const Eigen::Vector2d high = a + Eigen::Vector2d::Zero().cwiseMax(ab).cwiseMax(ac);
    for (int y = std::max(0, static_cast<int>(low.y())); y <= std::min(size - 1, static_cast<int>(high.y()));
         ++y)
      for (int x = std::max(0, static_cast<int>(low.x()));
           x <= std::min(size - 1, static_cast<int>(high.x())); ++x) {
        const Eigen::Vector2d p = Eigen::Vector2d(x + 0.5, y + 0.5) - a;
        const double b1 = (p.x() * ac.y() - p.y() * ac.x()) / area;
        const double b2 = (ab.x() * p.y() - ab.y() * p.x()) / area;
        if (b1 < -1e-6 || b2 < -1e-6 || b1 + b2 > 1 + 1e-6) continue;
        map[static_cast<std::size_t>(y) * size + x] = {static_cast<std::int32_t>(t), static_cast<float>(b1),
                                                       static_cast<float>(b2)};
      }
  }
  return map;
}

/// Gives every uncovered texel the colour of a nearest covered one, spreading ring by ring.
void fill_gutters(Image& image, const std::vector<Covered>& map) {
  const int size = image.width;
  std::vector<bool> done(map.size());
  std::vector<int> front;
  for (std::size_t i = 0; i < map.size(); ++i)
    if ((done[i] = map[i].triangle >= 0)) front.push_back(static_cast<int>(i));
  while (!front.empty()) {
    std::vector<int> next;
    for (const int i : front) {
      const int x = i % size;
      const int y = i / size;
      for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        if (x + dx < 0 || x + dx >= size || y + dy < 0 || y + dy >= size) continue;
        const int n = i + dx + dy * size;
        if (done[n]) continue;
        done[n] = true;
        std::copy_n(image.pixel(x, y), 4, image.pixel(x + dx, y + dy));
        next.push_back(n);
      }
    }
    front = std::move(next);
  }
}

}  // namespace

double noise(const Vec3& p) {
  const Vec3 floor = p.array().floor();
  const Eigen::Vector3i cell = floor.cast<int>();
  const Vec3 f = p - floor;
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i step(corner & 1, corner >> 1 & 1, corner >> 2);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? fade(f[axis]) : 1 - fade(f[axis]);
    sum += weight * gradient(cell + step, f - step.cast<double>());
  }
  return sum;
}

double fractal_noise(Vec3 p, int octaves) {
  double sum = 0;
  double strength = 0.6;
  for (int i = 0; i < octaves; ++i) {
    sum += strength * noise(p);
    strength *= 0.5;
    p = 2.03 * p + Vec3(17.3, 5.1, 9.7);
  }
  return sum;
}

Image paint_texture(const Mesh& mesh, const std::vector<double>& shades, int size,
                    const ColourField& colour) {
  const std::vector<Covered> map = rasterise(mesh, size);
  Image image;
  image.width = image.height = size;
  image.channels = 3;
  image.rgba.assign(4 * map.size(), 65535);
  parallel_for(size, [&](int y) {
    for (int x = 0; x < size; ++x) {
      const Covered& at = map[static_cast<std::size_t>(y) * size + x];
      if (at.triangle < 0) continue;
      const Triangle& t = mesh.triangles[at.triangle];
      const double b0 = 1 - at.b1 - at.b2;
      const Vec3 position =
          b0 * mesh.positions[t[0]] + at.b1 * mesh.positions[t[1]] + at.b2 * mesh.positions[t[2]];
      const Vec3 normal = b0 * mesh.normals[t[0]] + at.b1 * mesh.normals[t[1]] + at.b2 * mesh.normals[t[2]];
      const double shade =
          shades.empty() ? 1 : b0 * shades[t[0]] + at.b1 * shades[t[1]] + at.b2 * shades[t[2]];
      const Colour c = colour(position, normal.normalized(), shade);
      for (int i = 0; i < 3; ++i)
        image.pixel(x, y)[i] =
            static_cast<std::uint16_t>(257 * std::lround(255 * std::clamp(c[i], 0.0, 1.0)));
    }
  });
  fill_gutters(image, map);
  return image;
}

}  // namespace applique::assets
