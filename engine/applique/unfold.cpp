#include "applique/unfold.h"

#include <algorithm>
#include <limits>

#include "applique/base/predicates.h"

namespace applique {
namespace {

/// How many rings of vertices round what is turned over may move; more while it does not do.
constexpr std::array<int, 4> reaches = {2, 6, 18, std::numeric_limits<int>::max()};

bool turned(const std::vector<Vec2>& image, const std::array<int, 3>& f) {
  return orientation(image[f[0]], image[f[1]], image[f[2]]) <= 0;
}

/// By vertex whether it may move: the features' triangles, and those within `rings` of what is turned over.
std::vector<char> free_vertices(const DiscGeometry& disc, const std::vector<Vec2>& image,
                                std::span<const PlacedPoint> features, int rings) {
  std::vector<char> free(disc.vertices, 0);
  for (const auto& f : disc.faces)
    if (turned(image, f))
      for (const int v : f) free[v] = 1;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<char> wider = free;
    for (const auto& f : disc.faces)
      if (free[f[0]] || free[f[1]] || free[f[2]])
        for (const int v : f) wider[v] = 1;
    if (wider == free) break;
    free = std::move(wider);
  }
  for (const PlacedPoint& feature : features)
    for (const int v : feature.corners) free[v] = 1;
  return free;
}

/// The part of the disc that moves, with vertices of its own numbering.
struct Part {
  Tangle tangle;
  std::vector<int> vertices;  ///< Of the disc.
};

Part part_of(const DiscGeometry& disc, double scale, const std::vector<char>& free,
             std::span<const PlacedPoint> features) {
  Part part;
  std::vector<int> number(disc.vertices, -1);
  const auto numbered = [&](std::array<int, 3> f) {
    for (int& v : f) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(part.vertices.size());
        part.vertices.push_back(v);
        part.tangle.fixed.push_back(!free[v]);
      }
      v = number[v];
    }
    return f;
  };
  for (std::size_t t = 0; t < disc.faces.size(); ++t) {
    const auto& f = disc.faces[t];
    if (!free[f[0]] && !free[f[1]] && !free[f[2]]) continue;
    part.tangle.faces.push_back(numbered(f));
    auto rest = disc.flat(t);
    for (Vec2& corner : rest) corner *= scale;
    part.tangle.rest.push_back(rest);
  }
  for (const PlacedPoint& feature : features)
    part.tangle.placed.push_back({numbered(feature.corners), feature.barycentric, feature.target});
  return part;
}

}  // namespace

Unfolded unfold_image(const DiscGeometry& disc, double scale, std::vector<Vec2> image,
                      std::span<const PlacedPoint> features) {
  for (const int rings : reaches) {
    const std::vector<char> free = free_vertices(disc, image, features, rings);
    const Part part = part_of(disc, scale, free, features);
    std::vector<Vec2> plane;
    for (const int v : part.vertices) plane.push_back(image[v]);
    const Untangled untangled = untangle(part.tangle, std::move(plane));
    const bool all = part.vertices.size() == disc.vertices;
    if (untangled.flips == 0 || all || rings == reaches.back()) {
      Unfolded unfolded{std::move(image), untangled.flips};
      for (std::size_t i = 0; i < part.vertices.size(); ++i)
        unfolded.image[part.vertices[i]] = untangled.plane[i];
      return unfolded;
    }
  }
  return {std::move(image), 0};
}

}  // namespace applique
