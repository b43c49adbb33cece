#include "applique/transfer/refine.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "applique/base/parallel.h"

namespace applique {
namespace {

constexpr double coarse_tolerance = 0.04;  // Pixels.
constexpr int most_cells = 1024;
constexpr double most_gained = 5;  // By halving: a quarter of a smooth map's error is left.

std::size_t point_count(int cells) {
  return static_cast<std::size_t>(cells + 1) * (cells + 2) / 2;
}

// The grid of twice as many cells: the points that there are, and the warp at the new ones.
std::vector<Pixel> doubled(const Transfer& transfer, std::size_t face, int cells,
                           const std::vector<Pixel>& points) {
  const int fine = 2 * cells;
  std::vector<Pixel> result;
  result.reserve(point_count(fine));
  for (int j = 0; j <= fine; ++j) {
    for (int i = 0; i + j <= fine; ++i) {
      if (i % 2 == 0 && j % 2 == 0) {
        result.push_back(points[RefinedFace::index(cells, i / 2, j / 2)]);
        continue;
      }
      result.push_back(
          warp_in_face(transfer, face, static_cast<double>(i) / fine, static_cast<double>(j) / fine));
    }
  }
  return result;
}

// Largest distance of the new points of a doubled grid from the middles of the edges that they lie on.
double deviation(int fine, const std::vector<Pixel>& points) {
  double largest = 0;
  for (int j = 0; j <= fine; ++j) {
    for (int i = 0; i + j <= fine; ++i) {
      if (i % 2 == 0 && j % 2 == 0) continue;
      // The edge runs along i, along j, or across.
      const int di = i % 2, dj = i % 2 == 0 ? 1 : -(j % 2);
      const Pixel &a = points[RefinedFace::index(fine, i - di, j - dj)],
                  &b = points[RefinedFace::index(fine, i + di, j + dj)],
                  &m = points[RefinedFace::index(fine, i, j)];
      largest = std::max(largest, std::hypot(m.x - 0.5 * (a.x + b.x), m.y - 0.5 * (a.y + b.y)));
    }
  }
  return largest;
}

// How far all the points are from the image at least, less what the filter of a texel may reach, where
// `texels` lie between them. Below 0 where they may show it.
double beyond_image(const ImageFrame& frame, const std::vector<Pixel>& points, double texels) {
  double left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
  for (const Pixel& pixel : points) {
    left = std::min(left, pixel.x);
    right = std::max(right, pixel.x);
    top = std::min(top, pixel.y);
    bottom = std::max(bottom, pixel.y);
  }
  const double gap = std::max({left - frame.width, -right, top - frame.height, -bottom});
  return gap - 4 - 4 * std::hypot(right - left, bottom - top) / std::sqrt(texels);
}

RefinedFace refine_face(const Transfer& transfer, std::size_t face, const TexelBounds& shown) {
  const double texels = std::min(0.5 * std::abs(doubled_area(transfer.faces[face].texel)),
                                 (shown.upper[0] - shown.lower[0]) * (shown.upper[1] - shown.lower[1]));
  RefinedFace refined;
  for (const Vec2 image : transfer.faces[face].image)
    refined.points.push_back(transfer.image->frame.to_pixel(image));
  // A share that rises from nothing to all across the face is right in its middle by symmetry: with groups,
  // the first look is finer.
  const int coarsest = transfer.warp->groups > 1 ? 2 : 1;
  int finest = 1;
  while (finest < most_cells && static_cast<double>(point_count(2 * finest)) < texels) finest *= 2;
  for (int cells = 1; cells < finest; cells *= 2) {
    refined.points = doubled(transfer, face, cells, refined.points);
    const double apart = deviation(2 * cells, refined.points);
    // Far from the image it makes no difference where they are exactly.
    const double beyond = beyond_image(transfer.image->frame, refined.points, texels);
    if (cells >= coarsest && apart <= std::max(coarse_tolerance, beyond / 4)) {
      refined.cells = 2 * cells;
      return refined;
    }
    if (apart > coarse_tolerance * std::pow(most_gained, std::log2(finest / (2.0 * cells)))) break;
  }
  return {};
}

}  // namespace

Pixel RefinedFace::at(double x, double y) const {
  const int j = std::clamp(static_cast<int>(std::floor(y)), 0, cells - 1);
  const int i = std::clamp(static_cast<int>(std::floor(x)), 0, cells - 1 - j);
  double fx = x - i, fy = y - j;
  const Pixel &along = points[index(cells, i + 1, j)], &across = points[index(cells, i, j + 1)];
  const bool upper = fx + fy > 1 && i + j < cells - 1;
  const Pixel& corner = points[upper ? index(cells, i + 1, j + 1) : index(cells, i, j)];
  // From the upper triangle's right angle, the way to `across` is along x and the way to `along` is along y.
  if (upper) std::tie(fx, fy) = std::pair(1 - fy, 1 - fx);
  return {corner.x + fx * (along.x - corner.x) + fy * (across.x - corner.x),
          corner.y + fx * (along.y - corner.y) + fy * (across.y - corner.y)};
}

Pixel warp_in_face(const Transfer& transfer, std::size_t face, double u, double v) {
  const auto& plane = transfer.faces[face].plane;
  const Vec2 p = plane[0] + u * (plane[1] - plane[0]) + v * (plane[2] - plane[0]);
  const std::size_t groups = transfer.warp->groups;
  std::vector<double> influence;
  for (std::size_t g = 0; g < groups && groups > 1; ++g) {
    const double* corner = &transfer.influence[3 * face * groups + g];
    influence.push_back(corner[0] + u * (corner[groups] - corner[0]) + v * (corner[2 * groups] - corner[0]));
  }
  return transfer.image->frame.to_pixel((*transfer.warp)(p, influence));
}

std::vector<RefinedFace> refine_faces(const Transfer& transfer,
                                      std::span<const std::optional<TexelBounds>> shown) {
  std::vector<RefinedFace> refined(transfer.faces.size());
  if (!transfer.warp || transfer.warp->steps == 0) return refined;
  APPLIQUE_ASSERT(transfer.warp->groups == 1 ||
                  transfer.influence.size() == 3 * transfer.faces.size() * transfer.warp->groups);
  parallel_for(static_cast<int>(refined.size()), [&](int i) {
    if (!transfer.faces[i].linear && shown[i])
      refined[i] = refine_face(transfer, static_cast<std::size_t>(i), *shown[i]);
  });
  return refined;
}

}  // namespace applique
