#include "explain/layout.h"

#include <algorithm>

namespace applique {
namespace {

constexpr double least_extent = 1e-9;   // of what is shown, plane units
constexpr double margin_share = 0.025;  // of the picture's shorter side

struct Grid {
  Vec2 cell;
  double margin;
};

Grid grid_of(PictureSize size, std::size_t columns, std::size_t rows) {
  const double margin = margin_share * std::min(size.width, size.height);
  const auto c = static_cast<double>(columns), r = static_cast<double>(rows);
  return {{(size.width - (c + 1) * margin) / c, (size.height - (r + 1) * margin) / r}, margin};
}

Box bounds_of(std::span<const Vec2> points) {
  Vec2 low = points.front(), high = low;
  for (const Vec2 z : points) {
    low = {std::min(low.real(), z.real()), std::min(low.imag(), z.imag())};
    high = {std::max(high.real(), z.real()), std::max(high.imag(), z.imag())};
  }
  return {low, high - low};
}

}  // namespace

draw::Outline Box::outline() const {
  return {low, low + size.real(), low + size, low + Vec2(0, size.imag())};
}

std::vector<Box> lay_out(PictureSize size, std::size_t count, double aspect) {
  std::size_t best_columns = 1;
  double best_height = -1;
  for (std::size_t columns = 1; columns <= count; ++columns) {
    const Vec2 cell = grid_of(size, columns, (count + columns - 1) / columns).cell;
    const double height = std::min(cell.imag(), cell.real() / aspect);
    if (height <= best_height) continue;
    best_height = height;
    best_columns = columns;
  }
  const auto [cell, margin] = grid_of(size, best_columns, (count + best_columns - 1) / best_columns);
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<double>(i % best_columns);
    const std::size_t full_rows = i / best_columns;
    const auto row = static_cast<double>(full_rows);
    boxes.push_back(
        {{margin + column * (cell.real() + margin), margin + row * (cell.imag() + margin)}, cell});
  }
  return boxes;
}

draw::Outline PlaneView::operator()(std::span<const Vec2> line) const {
  draw::Outline outline;
  for (const Vec2 z : line) outline.push_back((*this)(z));
  return outline;
}

double aspect_of(std::span<const Vec2> points) {
  const Vec2 extent = bounds_of(points).size;
  return extent.real() / std::max(extent.imag(), least_extent);
}

PlaneView fit(std::span<const Vec2> points, const Box& box, double margin) {
  const Box bounds = bounds_of(points);
  const Vec2 room = (1 - 2 * margin) * box.size;
  return {bounds.middle(), box.middle(),
          std::min(room.real() / std::max(bounds.size.real(), least_extent),
                   room.imag() / std::max(bounds.size.imag(), least_extent))};
}

}  // namespace applique
