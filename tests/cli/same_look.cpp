#include "cli/same_look.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "applique/image/decal_image.h"

#include "uv_raster.h"

namespace applique {
namespace {

using Colour = std::array<double, 4>;

/// Base colours of a model, its images decoded once.
class Looks {
 public:
  explicit Looks(const Model& model) : model_(model) {
    for (const ModelPart& part : model.parts)
      if (const auto image = image_of(part); image && !images_.contains(*image))
        images_[*image] = load_model_image(model, *image).value();
  }

  [[nodiscard]] Colour at(const ModelPart& part, std::size_t t, const std::array<double, 3>& weights) const {
    Colour factor = {1, 1, 1, 1};
    if (part.material) factor = model_.materials[*part.material].base_colour_factor;
    const auto image = image_of(part);
    Colour colour =
        image && !part.uvs.empty() ? sample(part, t, weights, images_.at(*image)) : Colour{1, 1, 1, 1};
    for (std::size_t c = 0; c < 4; ++c) colour[c] *= factor[c];
    for (std::size_t c = 0; c < 4; ++c)
      colour[c] = 255 * (c < 3 ? linear_to_srgb(std::clamp(colour[c], 0.0, 1.0)) : colour[c]);
    return colour;
  }

 private:
  [[nodiscard]] std::optional<std::size_t> image_of(const ModelPart& part) const {
    return part.material ? model_.materials[*part.material].image : std::nullopt;
  }

  /// Linear light.
  [[nodiscard]] Colour sample(const ModelPart& part, std::size_t t, const std::array<double, 3>& weights,
                              const Image& image) const {
    const ModelMaterial& material = model_.materials[*part.material];
    double x = -0.5;
    double y = -0.5;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& uv = part.uvs[part.triangles[t][k]];
      x += weights[k] * uv[0] * image.width;
      y += weights[k] * uv[1] * image.height;
    }
    Colour sum = {};
    for (int k = 0; k < 4; ++k) {
      const auto column = static_cast<std::int64_t>(std::floor(x)) + k % 2;
      const auto row = static_cast<std::int64_t>(std::floor(y)) + k / 2;
      const double weight =
          (1 - std::abs(x - static_cast<double>(column))) * (1 - std::abs(y - static_cast<double>(row)));
      const std::uint16_t* texel = image.pixel(wrap_texel(column, image.width, material.wrap_u),
                                               wrap_texel(row, image.height, material.wrap_v));
      for (std::size_t c = 0; c < 4; ++c)
        sum[c] += weight * (c < 3 ? srgb_to_linear(texel[c] / 65535.0) : texel[c] / 65535.0);
    }
    return sum;
  }

  const Model& model_;
  std::map<std::size_t, Image> images_;
};

using Corner = std::array<double, 3>;

std::array<Corner, 3> corners_of(const ModelPart& part, std::size_t t) {
  std::array<Corner, 3> corners = {};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& p = part.positions[part.triangles[t][k]];
    corners[k] = {p.x(), p.y(), p.z()};
  }
  return corners;
}

}  // namespace

LookDifference compare_looks(const Model& before, const Model& after) {
  const Looks looks_before(before);
  const Looks looks_after(after);
  std::map<std::array<Corner, 3>, std::vector<std::pair<const ModelPart*, std::size_t>>> known;
  for (const ModelPart& part : before.parts)
    for (std::size_t t = 0; t < part.triangles.size(); ++t) known[corners_of(part, t)].emplace_back(&part, t);
  LookDifference difference;
  for (const ModelPart& part : after.parts)
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      ++difference.triangles;
      const auto same = known.find(corners_of(part, t));
      if (same == known.end()) {
        ++difference.missing;
        continue;
      }
      double least = HUGE_VAL;
      for (const auto& [old_part, old_triangle] : same->second) {
        double largest = 0;
        for (const std::array<double, 3>& weights : {std::array{1.0, 0.0, 0.0},
                                                     {0.0, 1.0, 0.0},
                                                     {0.0, 0.0, 1.0},
                                                     {0.341, 0.329, 0.33},
                                                     {0.71, 0.2, 0.09},
                                                     {0.1, 0.55, 0.35},
                                                     {0.02, 0.5, 0.48},
                                                     {0.27, 0.13, 0.6}}) {
          const Colour old_colour = looks_before.at(*old_part, old_triangle, weights);
          const Colour colour = looks_after.at(part, t, weights);
          for (std::size_t c = 0; c < 4; ++c)
            largest = std::max(largest, std::abs(colour[c] - old_colour[c]));
        }
        least = std::min(least, largest);
      }
      difference.largest = std::max(difference.largest, least);
    }
  return difference;
}

std::array<double, 4> colour_near(const Model& model, const Vec3& position) {
  const Looks looks(model);
  double nearest = HUGE_VAL;
  Colour colour = {};
  for (const ModelPart& part : model.parts)
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      std::array<Vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = part.positions[part.triangles[t][k]];
      const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
      std::array<double, 3> weights = {};
      for (std::size_t k = 0; k < 3; ++k)
        weights[k] =
            (p[(k + 1) % 3] - position).cross(p[(k + 2) % 3] - position).dot(normal) / normal.squaredNorm();
      if (*std::min_element(weights.begin(), weights.end()) < -1e-9) continue;
      const double distance = std::abs((position - p[0]).dot(normal.normalized()));
      if (distance >= nearest) continue;
      nearest = distance;
      colour = looks.at(part, t, weights);
    }
  return colour;
}

}  // namespace applique
