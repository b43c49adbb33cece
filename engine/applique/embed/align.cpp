#include "applique/embed/align.h"

#include <vector>

namespace applique {
namespace {

Vec2 centroid(std::span<const Vec2> points) {
  Vec2 sum = 0;
  for (Vec2 z : points) sum += z;
  return sum / static_cast<double>(points.size());
}

double residual(std::span<const Vec2> from, std::span<const Vec2> to) {
  const Similarity fit = fit_similarity(from, to);
  double sum = 0;
  for (std::size_t k = 0; k < from.size(); ++k) sum += std::norm(fit(from[k]) - to[k]);
  return sum;
}

}  // namespace

Similarity fit_similarity(std::span<const Vec2> from, std::span<const Vec2> to) {
  const Vec2 from_centre = centroid(from), to_centre = centroid(to);
  Vec2 correlation = 0;
  double spread = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    correlation += std::conj(from[k] - from_centre) * (to[k] - to_centre);
    spread += std::norm(from[k] - from_centre);
  }
  const Vec2 scale = correlation / spread;
  return {scale, to_centre - scale * from_centre};
}

bool is_mirrored(std::span<const Vec2> from, std::span<const Vec2> to) {
  if (from.size() < 3) return false;
  std::vector<Vec2> reflected(from.begin(), from.end());
  for (Vec2& z : reflected) z = std::conj(z);
  double size = 0;
  const Vec2 centre = centroid(to);
  for (Vec2 z : to) size += std::norm(z - centre);
  // A correspondence near a similarity is fine, and so is one that neither explains.
  const double direct = residual(from, to);
  return direct > 0.02 * size && residual(reflected, to) < 0.5 * direct;
}

}  // namespace applique
