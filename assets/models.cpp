#include "models.h"

#include <algorithm>

#include "atlas.h"
#include "bottle.h"
#include "bust.h"
#include "parallel.h"
#include "polygonise.h"
#include "remesh.h"

namespace applique::assets {
namespace {

/// Texels between charts: 16 of 2048.
int gutter(int texture_size) {
  return texture_size / 128;
}

Colour blend(const Colour& a, const Colour& b, double t) {
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

/// Warm marble: clouds, thin veins where a warped noise crosses zero, and brown dust in the cavities.
Colour marble(const Vec3& position, const Vec3& normal, double open) {
  const Vec3 warped = position + 0.35 * Vec3(fractal_noise(1.3 * position, 3),
                                             fractal_noise(1.3 * position + Vec3(7, 3, 1), 3),
                                             fractal_noise(1.3 * position + Vec3(2, 9, 4), 3));
  const double clouds = fractal_noise(1.1 * warped, 4);
  // Veins fade in and out, so that they do not read as contour lines.
  const double presence = std::clamp(0.2 + 1.6 * noise(0.8 * position + Vec3(11, 5, 3)), 0.0, 1.0);
  const double vein = std::max(0.0, 1 - 14 * std::abs(noise(0.75 * warped)));
  const double smear = std::max(0.0, 1 - 3.5 * std::abs(noise(0.75 * warped)));
  const double grain = noise(55 * position);
  Colour c = blend(Colour(0.905, 0.875, 0.83), Colour(0.82, 0.785, 0.745), 0.5 + 0.8 * clouds);
  c = blend(c, Colour(0.62, 0.59, 0.57), presence * (0.34 * vein * vein + 0.16 * smear * smear));
  c *= 1 + 0.012 * grain;
  // Dust settles where the surface is hidden, and a little where it looks up.
  c = blend(c, Colour(0.44, 0.35, 0.28), 0.8 * (1 - open));
  return blend(c, Colour(0.80, 0.74, 0.66), 0.18 * std::max(normal.y(), 0.0));
}

Colour glass(const Vec3& position, const Vec3&, double) {
  if (position.y() > bottle_cork_height) {
    const double grain = fractal_noise(Vec3(14, 26, 14).cwiseProduct(position), 3);
    return blend(Colour(0.74, 0.58, 0.40), Colour(0.52, 0.37, 0.23), 0.4 + 0.9 * grain);
  }
  const double streak = fractal_noise(Vec3(1.6, 0.5, 1.6).cwiseProduct(position), 3);
  const double depth = std::clamp(position.y() / 3.2, 0.0, 1.0);
  return blend(Colour(0.07, 0.20, 0.12), Colour(0.13, 0.33, 0.19), 0.35 + 0.4 * depth + 0.25 * streak);
}

}  // namespace

Mesh make_bust_mesh() {
  PolygoniseOptions options;
  options.low = Vec3(-1.9, -0.1, -1.4);
  options.high = Vec3(1.9, 5.1, 1.3);
  options.focus = head_to_scene(Vec3(0, -0.25, 0.8));
  options.focus_radius = 0.7;
  options.fine = 0.03;
  options.coarse = 0.1;
  options.smoothing = 2;
  RemeshOptions edges;
  edges.finest = [](const Vec3& p) { return p.y() < 2 ? 0.04 : 0.015; };
  edges.coarsest = 0.085;
  edges.fineness = 0.36;
  return remesh(polygonise(bust_distance, options), bust_distance, edges);
}

Result<Model> make_bust(int texture_size) {
  Model model;
  const Mesh mesh = make_bust_mesh();
  APPLIQUE_TRY(model.mesh, unwrap(mesh, segment(mesh, bust_chart), bust_chart_density, texture_size,
                                  gutter(texture_size)));
  std::vector<double> open(model.mesh.positions.size());
  parallel_for(static_cast<int>(open.size() + 255) / 256, [&](int block) {
    for (std::size_t v = 256UL * block; v < std::min<std::size_t>(open.size(), 256UL * (block + 1)); ++v)
      open[v] = openness(bust_distance, model.mesh.positions[v], model.mesh.normals[v], 0.35);
  });
  model.texture = paint_texture(model.mesh, open, texture_size, marble);
  return model;
}

Result<Model> make_bottle(int texture_size) {
  Model model;
  const Mesh mesh = bottle_mesh();
  APPLIQUE_TRY(model.mesh, unwrap(mesh, segment(mesh, bottle_chart), bottle_chart_density, texture_size,
                                  gutter(texture_size)));
  model.texture = paint_texture(model.mesh, {}, texture_size, glass);
  return model;
}

}  // namespace applique::assets
