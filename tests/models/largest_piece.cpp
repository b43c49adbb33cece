#include "models/largest_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <vector>

namespace applique {
namespace {

struct FaceShape {
  Vec3 middle;
  Vec3 normal;  // unit, or zero
  double area;
};

std::vector<FaceShape> measure_faces(const SurfaceMesh& mesh) {
  std::vector<FaceShape> shapes;
  for (const FaceId f : ids<FaceId>(mesh.faces.size())) {
    const auto [a, b, c] = mesh.corners(f);
    const Vec3 normal = (b - a).cross(c - a);
    shapes.push_back({(a + b + c) / 3, normal.normalized(), 0.5 * normal.norm()});
  }
  return shapes;
}

/// The part with the largest area.
std::uint32_t find_largest_part(const Model& model, const ModelSurface& surface,
                                const std::vector<FaceShape>& shapes) {
  std::vector<double> areas(model.parts.size(), 0);
  for (const FaceId f : ids<FaceId>(shapes.size())) areas[surface.source(f).part] += shapes[f.value].area;
  return static_cast<std::uint32_t>(std::max_element(areas.begin(), areas.end()) - areas.begin());
}

class Pieces {
 public:
  Pieces(const ModelSurface& surface, const std::vector<FaceShape>& shapes, std::uint32_t part)
      : surface_(surface), shapes_(shapes), part_(part) {}

  [[nodiscard]] std::vector<FaceId> largest() const {
    std::vector<char> seen(shapes_.size(), 0);
    std::vector<FaceId> best;
    double best_area = -1;
    for (const FaceId f : ids<FaceId>(shapes_.size())) {
      if (seen[f.value] != 0 || surface_.source(f).part != part_) continue;
      std::vector<FaceId> piece = {f};
      seen[f.value] = 1;
      double area = 0;
      for (std::size_t i = 0; i < piece.size(); ++i) {
        area += shapes_[piece[i].value].area;
        for (const FaceId next : surface_.mesh.neighbours[piece[i]])
          if (joins(piece[i], next) && seen[next.value] == 0) {
            seen[next.value] = 1;
            piece.push_back(next);
          }
      }
      if (area <= best_area) continue;
      best_area = area;
      best = std::move(piece);
    }
    return best;
  }

  /// How far each face's middle is from the piece's border, along middles; infinite without a border.
  [[nodiscard]] std::vector<double> distances_from_border(const std::vector<FaceId>& piece) const {
    using Entry = std::pair<double, std::uint32_t>;
    std::vector<double> distance(shapes_.size(), std::numeric_limits<double>::infinity());
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto reach = [&](FaceId f, double d) {
      if (d >= distance[f.value]) return;
      distance[f.value] = d;
      queue.emplace(d, f.value);
    };
    for (const FaceId f : piece) {
      const auto corners = surface_.mesh.corners(f);
      for (std::size_t k = 0; k < 3; ++k) {
        const double base = (corners[(k + 2) % 3] - corners[(k + 1) % 3]).norm();
        if (!joins(f, surface_.mesh.neighbours[f][k]))
          reach(f, base > 0 ? 2 * shapes_[f.value].area / (3 * base) : 0);
      }
    }
    while (!queue.empty()) {
      const auto [d, at] = queue.top();
      queue.pop();
      if (d > distance[at]) continue;
      for (const FaceId next : surface_.mesh.neighbours[FaceId(at)])
        if (joins(FaceId(at), next))
          reach(next, d + (shapes_[next.value].middle - shapes_[at].middle).norm());
    }
    return distance;
  }

 private:
  [[nodiscard]] bool joins(FaceId a, FaceId b) const {
    static const double sharpest = std::cos(40 * std::numbers::pi / 180);
    return b.valid() && surface_.source(b).part == part_ &&
           shapes_[a.value].normal.dot(shapes_[b.value].normal) > sharpest;
  }

  const ModelSurface& surface_;
  const std::vector<FaceShape>& shapes_;
  std::uint32_t part_;
};

}  // namespace

DecalPlace find_place(const Model& model) {
  const ModelSurface surface = build_surface(model);
  const auto shapes = measure_faces(surface.mesh);
  const Pieces pieces(surface, shapes, find_largest_part(model, surface, shapes));
  const auto piece = pieces.largest();
  const auto distance = pieces.distances_from_border(piece);
  const FaceId middle = *std::max_element(
      piece.begin(), piece.end(), [&](FaceId a, FaceId b) { return distance[a.value] < distance[b.value]; });
  double area = 0;
  for (const FaceId f : piece) area += shapes[f.value].area;

  DecalPlace place;
  place.triangles = piece.size();
  place.position = shapes[middle.value].middle;
  if (std::abs(shapes[middle.value].normal.y()) > 0.9) place.up = Vec3::UnitZ();
  // The corners of the square lie sqrt(2) half widths from its middle.
  place.size = std::min(std::sqrt(2.0) * distance[middle.value], 0.4 * std::sqrt(area));
  return place;
}

nlohmann::json job_at(const DecalPlace& place, const std::filesystem::path& model,
                      const std::filesystem::path& image, int pixels, const nlohmann::json& decal) {
  const auto vector = [](const Vec3& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  nlohmann::json entry = {
      {"name", "decal"},
      {"image", image.string()},
      {"size", place.size},
      {"up", vector(place.up)},
      {"features", {{{"image", {0.5 * pixels, 0.5 * pixels}}, {"position", vector(place.position)}}}}};
  if (!decal.is_null()) entry.update(decal);
  return {{"version", 1},
          {"model", model.string()},
          {"texture_size", 512},
          {"decals", nlohmann::json::array({entry})}};
}

}  // namespace applique
