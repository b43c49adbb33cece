#include "preview.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace applique::assets {

Image preview(const Mesh& mesh, const Image* texture, const View& view, int width, int height) {
  const double radians = std::numbers::pi / 180;
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(view.elevation * radians, Vec3::UnitX()) *
                                Eigen::AngleAxisd(-view.azimuth * radians, Vec3::UnitY()))
                                   .toRotationMatrix();
  constexpr int samples = 2;  // a side, for anti-aliasing
  const int w = samples * width;
  const int h = samples * height;
  const double scale = h / view.height;
  std::vector<double> depth(static_cast<std::size_t>(w) * h, -1e9);
  std::vector<Vec3> colour(depth.size(), Vec3(0.93, 0.93, 0.92));
  const Vec3 key = Vec3(-0.55, 0.6, 0.6).normalized();
  const Vec3 fill = Vec3(0.8, 0.1, 0.4).normalized();
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec3, 3> p;
    std::array<Vec3, 3> n;
    for (int i = 0; i < 3; ++i) {
      const Vec3 q = turn * (mesh.positions[t[i]] - view.target);
      p[i] = Vec3(0.5 * w + scale * q.x(), 0.5 * h - scale * q.y(), q.z());
      n[i] = turn * mesh.normals[t[i]];
    }
    const auto area2 = [](const Vec3& a, const Vec3& b, double x, double y) {
      return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
    };
    const double area = area2(p[0], p[1], p[2].x(), p[2].y());
    if (area >= 0) continue;
    const int x0 = std::max(0, static_cast<int>(std::min({p[0].x(), p[1].x(), p[2].x()})));
    const int x1 = std::min(w - 1, static_cast<int>(std::max({p[0].x(), p[1].x(), p[2].x()})) + 1);
    const int y0 = std::max(0, static_cast<int>(std::min({p[0].y(), p[1].y(), p[2].y()})));
    const int y1 = std::min(h - 1, static_cast<int>(std::max({p[0].y(), p[1].y(), p[2].y()})) + 1);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double b0 = area2(p[1], p[2], x + 0.5, y + 0.5) / area;
        const double b1 = area2(p[2], p[0], x + 0.5, y + 0.5) / area;
        const double b2 = 1 - b0 - b1;
        if (b0 < 0 || b1 < 0 || b2 < 0) continue;
        const std::size_t i = static_cast<std::size_t>(y) * w + x;
        const double z = b0 * p[0].z() + b1 * p[1].z() + b2 * p[2].z();
        if (z <= depth[i]) continue;
        depth[i] = z;
        const Vec3 normal = (b0 * n[0] + b1 * n[1] + b2 * n[2]).normalized();
        Vec3 albedo(0.6, 0.56, 0.5);
        if (texture != nullptr) {
          const Eigen::Vector2d uv = b0 * mesh.uvs[t[0]] + b1 * mesh.uvs[t[1]] + b2 * mesh.uvs[t[2]];
          const int u = std::clamp(static_cast<int>(uv.x() * texture->width), 0, texture->width - 1);
          const int v = std::clamp(static_cast<int>(uv.y() * texture->height), 0, texture->height - 1);
          const std::uint16_t* texel = texture->pixel(u, v);
          for (int c = 0; c < 3; ++c) albedo[c] = std::pow(texel[c] / 65535.0, 2.2);
        }
        const double light = 1.15 * std::max(normal.dot(key), 0.0) + 0.22 * std::max(normal.dot(fill), 0.0) +
                             0.22 + 0.13 * normal.y();
        const Vec3 half = (key + Vec3::UnitZ()).normalized();
        const double shine = 0.12 * std::pow(std::max(normal.dot(half), 0.0), 30);
        for (int c = 0; c < 3; ++c)
          colour[i][c] = std::pow(std::clamp(albedo[c] * light + shine, 0.0, 1.0), 1 / 2.2);
      }
  }
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.resize(4UL * width * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Vec3 sum = Vec3::Zero();
      for (int s = 0; s < samples * samples; ++s) {
        const std::size_t row = samples * y + s / samples;
        const std::size_t column = samples * x + s % samples;
        sum += colour[row * w + column];
      }
      for (int c = 0; c < 3; ++c)
        image.pixel(x, y)[c] =
            static_cast<std::uint16_t>(257 * std::lround(255 * sum[c] / (samples * samples)));
      image.pixel(x, y)[3] = 65535;
    }
  return image;
}

}  // namespace applique::assets
