#include "applique/embed/align.h"

#include <algorithm>
#include <vector>

namespace applique {
namespace {

Vec2 centroid(std::span<const Vec2> points) {
  Vec2 sum = 0;
  for (Vec2 z : points) sum += z;
  return sum / static_cast<double>(points.size());
}

/// The best similarity of those that take one centre to the other.
Similarity fit_about(Vec2 from_centre, Vec2 to_centre, std::span<const Vec2> from, std::span<const Vec2> to) {
  Vec2 correlation = 0;
  double spread = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    correlation += std::conj(from[k] - from_centre) * (to[k] - to_centre);
    spread += std::norm(from[k] - from_centre);
  }
  const Vec2 scale = correlation / spread;
  return {scale, to_centre - scale * from_centre};
}

double residual(std::span<const Vec2> from, std::span<const Vec2> to) {
  const Similarity fit = fit_similarity(from, to);
  double sum = 0;
  for (std::size_t k = 0; k < from.size(); ++k) sum += std::norm(fit(from[k]) - to[k]);
  return sum;
}

}  // namespace

Similarity fit_similarity(std::span<const Vec2> from, std::span<const Vec2> to) {
  return fit_about(centroid(from), centroid(to), from, to);
}

Similarity fit_similarity_about(std::size_t fixed, std::span<const Vec2> from, std::span<const Vec2> to) {
  return fit_about(from[fixed], to[fixed], from, to);
}

Similarity fit_by_edges(std::span<const Vec2> from, std::span<const Vec2> to,
                        std::span<const std::array<std::uint32_t, 2>> edges) {
  double from_length = 0, to_length = 0;
  for (const auto& [i, j] : edges) {
    from_length += std::abs(from[j] - from[i]);
    to_length += std::abs(to[j] - to[i]);
  }
  const Vec2 scale = std::polar(to_length / from_length, std::arg(fit_similarity(from, to).scale));
  return {scale, centroid(to) - scale * centroid(from)};
}

bool is_mirrored(std::span<const Vec2> from, std::span<const Vec2> to,
                 std::span<const std::array<std::uint32_t, 3>> triangles) {
  if (from.size() < 3) return false;
  double turned = 0, kept = 0;
  for (const auto& [a, b, c] : triangles) {
    const double area = std::abs(cross(to[b] - to[a], to[c] - to[a]));
    (cross(from[b] - from[a], from[c] - from[a]) < 0 ? turned : kept) += area;
  }
  if (turned < kept) return false;
  std::vector<Vec2> reflected(from.begin(), from.end());
  for (Vec2& z : reflected) z = std::conj(z);
  double size = 0;
  const Vec2 centre = centroid(to);
  for (Vec2 z : to) size += std::norm(z - centre);
  // A correspondence near a similarity is fine, and so is one that neither explains.
  const double direct = residual(from, to);
  return direct > 0.02 * size && residual(reflected, to) < 0.5 * direct;
}

bool all_turned(std::span<const Vec2> features, std::span<const std::array<std::uint32_t, 3>> triangles) {
  return triangles.size() > 1 && std::all_of(triangles.begin(), triangles.end(), [&](const auto& t) {
           return cross(features[t[1]] - features[t[0]], features[t[2]] - features[t[0]]) < 0;
         });
}

}  // namespace applique
