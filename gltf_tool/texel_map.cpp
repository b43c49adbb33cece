#include "texel_map.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "uv_raster.h"

namespace applique {

TexelMap map_between(const std::array<Texel, 3>& from, const std::array<Texel, 3>& to) {
  const double area = doubled_area(from);
  std::array<double, 2> dx = {};
  std::array<double, 2> dy = {};
  for (std::size_t c = 0; c < 2; ++c) {
    const double u = to[1][c] - to[0][c];
    const double v = to[2][c] - to[0][c];
    dx[c] = (u * (from[2][1] - from[0][1]) - v * (from[1][1] - from[0][1])) / area;
    dy[c] = (v * (from[1][0] - from[0][0]) - u * (from[2][0] - from[0][0])) / area;
  }
  TexelMap map{dx[0], dy[0], dx[1], dy[1], 0, 0};
  const Texel origin = map(from[0]);
  map.x0 = to[0][0] - origin[0];
  map.y0 = to[0][1] - origin[1];
  return map;
}

std::array<double, 2> half_axes(const TexelMap& map) {
  // The singular values, from the squares' sum and the determinant.
  const double half = 0.5 * (map.xx * map.xx + map.xy * map.xy + map.yx * map.yx + map.yy * map.yy);
  const double determinant = std::abs(map.xx * map.yy - map.xy * map.yx);
  const double longer = std::sqrt(half + std::sqrt(std::max(0.0, half * half - determinant * determinant)));
  return {longer, longer > 0 ? determinant / longer : 0};
}

double usual_stretch(std::span<const std::array<Texel, 3>> from, std::span<const std::array<Texel, 3>> to) {
  constexpr double share = 0.95;
  std::vector<std::pair<double, double>> stretches;  // with their areas
  double total = 0;
  for (std::size_t t = 0; t < from.size(); ++t) {
    const double area = std::abs(doubled_area(from[t]));
    if (area == 0) continue;
    stretches.emplace_back(half_axes(map_between(from[t], to[t]))[0], area);
    total += area;
  }
  std::sort(stretches.begin(), stretches.end());
  double sum = 0;
  for (const auto& [stretch, area] : stretches)
    if ((sum += area) >= share * total) return stretch;
  return 0;
}

}  // namespace applique
