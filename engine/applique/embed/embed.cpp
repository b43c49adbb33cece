#include "applique/embed/embed.h"

#include <algorithm>
#include <cmath>

#include "applique/embed/arap.h"
#include "applique/embed/boundary_first.h"
#include "applique/embed/tutte.h"

namespace applique {
namespace {

bool finite(const std::vector<Vec2>& plane) {
  return std::all_of(plane.begin(), plane.end(),
                     [](Vec2 z) { return std::isfinite(z.real()) && std::isfinite(z.imag()); });
}

void scale_to_area(const DiscGeometry& disc, std::vector<Vec2>& plane) {
  double area = 0;
  for (const auto& f : disc.faces) area += 0.5 * cross(plane[f[1]] - plane[f[0]], plane[f[2]] - plane[f[0]]);
  if (!(area > 0)) return;
  const double scale = std::sqrt(disc.area / area);
  for (Vec2& z : plane) z *= scale;
}

/// The smallest t in (0, 1] at which a triangle moving linearly from a to b has no area, or 2.
double collapse_time(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  const Vec2 e = a[1] - a[0], f = a[2] - a[0];
  const Vec2 de = b[1] - b[0] - e, df = b[2] - b[0] - f;
  const double c0 = cross(e, f), c1 = cross(de, f) + cross(e, df), c2 = cross(de, df);
  const double discriminant = c1 * c1 - 4 * c2 * c0;
  if (discriminant < 0) return 2;
  // Stable roots of c2 t^2 + c1 t + c0.
  const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
  double first = 2;
  for (const double t : {q != 0 ? c0 / q : 2, c2 != 0 ? q / c2 : 2})
    if (t > 0 && t <= 1) first = std::min(first, t);
  return first;
}

/// Goes from `start`, which turns nothing over, towards `goal`, nine tenths of the way to the first collapse.
std::vector<Vec2> blend_before_fold(const DiscGeometry& disc, const std::vector<Vec2>& start,
                                    const std::vector<Vec2>& goal) {
  double t = 2;
  for (const auto& f : disc.faces)
    t = std::min(
        t, collapse_time({start[f[0]], start[f[1]], start[f[2]]}, {goal[f[0]], goal[f[1]], goal[f[2]]}));
  t = std::min(1.0, 0.9 * t);
  std::vector<Vec2> plane(start.size());
  for (std::size_t v = 0; v < plane.size(); ++v) plane[v] = start[v] + t * (goal[v] - start[v]);
  return plane;
}

}  // namespace

Embedding embed_disc(const DiscGeometry& disc, const EmbedOptions& options) {
  Embedding embedding{flatten_boundary_first(disc), EmbeddingRung::conformal, 0};
  if (!finite(embedding.plane) || (embedding.flips = count_flips(disc, embedding.plane)) > 0) {
    std::vector<Vec2> circle = embed_on_circle(disc);
    const std::size_t flips = count_flips(disc, circle);
    if (!finite(embedding.plane) || flips < embedding.flips)
      embedding = {std::move(circle), EmbeddingRung::circle, flips};
  }
  scale_to_area(disc, embedding.plane);
  if (options.energy == Energy::conformal) return embedding;

  std::vector<Vec2> relaxed = relax_arap(disc, embedding.plane, {options.max_iterations, options.tolerance});
  if (finite(relaxed)) {
    const std::size_t flips = count_flips(disc, relaxed);
    if (flips == 0 || flips < embedding.flips) return {std::move(relaxed), EmbeddingRung::isometric, flips};
    if (embedding.flips == 0) {
      std::vector<Vec2> blended = blend_before_fold(disc, embedding.plane, relaxed);
      if (count_flips(disc, blended) == 0) return {std::move(blended), EmbeddingRung::blended, 0};
    }
  }
  return embedding;
}

}  // namespace applique
