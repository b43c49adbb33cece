#include "applique/rivals/stroke_axis.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace applique {
namespace {

/// The features within `tolerance` of the line.
std::vector<std::size_t> near_line(const std::vector<Vec2>& features, Vec2 origin, Vec2 direction,
                                   double tolerance) {
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < features.size(); ++k)
    if (std::abs(cross(direction, features[k] - origin)) <= tolerance) near.push_back(k);
  return near;
}

/// The direction of the best fit to the features by a line through the origin.
Vec2 fit_direction(const std::vector<Vec2>& features, const std::vector<std::size_t>& which, Vec2 origin) {
  Vec2 doubled = 0;  // Squares forget which of its two ways a direction points.
  for (std::size_t k : which) doubled += (features[k] - origin) * (features[k] - origin);
  return std::polar(1.0, 0.5 * std::arg(doubled));
}

/// The features whose order along the axis is sure, from the anchor on either way.
std::vector<std::size_t> chain(const std::vector<Vec2>& features, std::vector<std::size_t> which,
                               std::size_t anchor, const StrokeAxis& axis) {
  std::sort(which.begin(), which.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(axis.along(features[a]), a) < std::pair(axis.along(features[b]), b);
  });
  const auto middle = std::find(which.begin(), which.end(), anchor);
  const auto walk = [&](auto from, auto end) {
    std::vector<std::size_t> kept = {anchor};
    for (auto k = from; k != end; ++k) {
      const Vec2 step = features[*k] - features[kept.back()];
      if (std::abs(dot(axis.direction, step)) > std::abs(cross(axis.direction, step))) kept.push_back(*k);
    }
    return kept;
  };
  std::vector<std::size_t> order = walk(std::make_reverse_iterator(middle), which.rend());
  std::reverse(order.begin(), order.end());
  const std::vector<std::size_t> after = walk(middle + 1, which.end());
  order.insert(order.end(), after.begin() + 1, after.end());
  return order;
}

}  // namespace

StrokeAxis find_stroke_axis(const std::vector<Vec2>& features, std::size_t anchor, double tolerance) {
  StrokeAxis axis{features[anchor], 1, {}, {}};
  std::vector<std::size_t> on_axis = {anchor};
  for (const Vec2 z : features) {
    if (z == axis.origin) continue;
    const Vec2 direction = (z - axis.origin) / std::abs(z - axis.origin);
    auto near = near_line(features, axis.origin, direction, tolerance);
    if (near.size() > on_axis.size()) on_axis = std::move(near);
  }
  if (on_axis.size() > 1) axis.direction = fit_direction(features, on_axis, axis.origin);
  axis.features = chain(features, std::move(on_axis), anchor, axis);
  for (std::size_t k : axis.features) axis.places.push_back(axis.along(features[k]));
  return axis;
}

}  // namespace applique
