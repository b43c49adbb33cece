#include "applique/embed/embed.h"

#include <algorithm>
#include <cmath>

#include "applique/embed/arap.h"
#include "applique/embed/boundary_first.h"
#include "applique/embed/collapse.h"
#include "applique/embed/mean_value.h"
#include "applique/embed/symmetric_dirichlet.h"

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

constexpr ArapOptions rough_arap{10, 1e-2};

Embedding descend(const DiscGeometry& disc, std::vector<Vec2> start) {
  Embedding embedding{relax_symmetric_dirichlet(disc, std::move(start)), EmbeddingRung::descended, 0};
  embedding.flips = count_flips(disc, embedding.plane);
  return embedding;
}

}  // namespace

Embedding embed_disc(const DiscGeometry& disc, const EmbedOptions& options, const std::vector<Vec2>& start) {
  if (options.energy == Energy::isometric && !options.rough && !start.empty() &&
      count_flips(disc, start) == 0)
    return descend(disc, start);
  Embedding embedding{flatten_boundary_first(disc), EmbeddingRung::conformal, 0};
  if (!finite(embedding.plane) || (embedding.flips = count_flips(disc, embedding.plane)) > 0) {
    std::vector<Vec2> circle = embed_on_circle(disc);
    const std::size_t flips = count_flips(disc, circle);
    if (!finite(embedding.plane) || flips < embedding.flips)
      embedding = {std::move(circle), EmbeddingRung::circle, flips};
  }
  scale_to_area(disc, embedding.plane);
  if (options.energy == Energy::conformal) return embedding;

  std::vector<Vec2> relaxed = relax_arap(disc, embedding.plane, options.rough ? rough_arap : ArapOptions{});
  if (finite(relaxed)) {
    const std::size_t flips = count_flips(disc, relaxed);
    if (flips == 0 || embedding.flips > 0 || options.rough)
      return {std::move(relaxed), EmbeddingRung::isometric, flips};
  }
  // A blend that stops before ARAP's first fold starts the descent next to its barrier, which costs more
  // steps than the flip-free map itself does.
  return descend(disc, std::move(embedding.plane));
}

}  // namespace applique
