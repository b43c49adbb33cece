#include "applique/embed/embed.h"

#include <algorithm>
#include <cmath>

#include "applique/embed/arap.h"
#include "applique/embed/boundary_first.h"
#include "applique/embed/least_stretch.h"
#include "applique/embed/mean_value.h"

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

constexpr double rough_tolerance = 1e-3, fine_tolerance = 1e-4;

Embedding descend(const DiscGeometry& disc, const EmbedOptions& options, const std::vector<Vec2>& start,
                  std::span<const PlacedPoint> guide = {}) {
  StretchOptions descent;
  descent.guide = guide;
  descent.weights = options.weights;
  descent.isometry = options.energy.isometry;
  descent.tolerance = options.rough ? rough_tolerance : fine_tolerance;
  Embedding embedding{relax_stretch(disc, start, descent), EmbeddingRung::isometric, 0};
  embedding.flips = count_flips(disc, embedding.plane);
  return embedding;
}

}  // namespace

Embedding embed_disc(const DiscGeometry& disc, const EmbedOptions& options, const std::vector<Vec2>& start) {
  if (options.energy != Energy::conformal && !start.empty() && count_flips(disc, start) == 0)
    return descend(disc, options, start, options.guide);
  Embedding embedding{flatten_boundary_first(disc), EmbeddingRung::conformal, 0};
  if (!finite(embedding.plane) || (embedding.flips = count_flips(disc, embedding.plane)) > 0) {
    std::vector<Vec2> circle = embed_on_circle(disc);
    const std::size_t flips = count_flips(disc, circle);
    if (!finite(embedding.plane) || flips < embedding.flips)
      embedding = {std::move(circle), EmbeddingRung::circle, flips};
  }
  scale_to_area(disc, embedding.plane);
  if (options.energy == Energy::conformal) return embedding;
  if (embedding.flips == 0) return descend(disc, options, embedding.plane);
  std::vector<Vec2> relaxed = relax_arap(disc, embedding.plane);
  if (!finite(relaxed)) return embedding;
  const std::size_t flips = count_flips(disc, relaxed);
  return {std::move(relaxed), EmbeddingRung::arap, flips};
}

}  // namespace applique
