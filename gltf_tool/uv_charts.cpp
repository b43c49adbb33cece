#include "uv_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "uv_raster.h"

namespace applique {
namespace {

/// A piece is looked at through at most so many texels.
constexpr double most_texels = 1 << 26;

class Grower {
 public:
  Grower(std::span<const std::array<Texel, 3>> corners, std::span<const std::vector<std::uint32_t>> beside)
      : corners_(corners), beside_(beside) {}

  std::vector<std::vector<std::uint32_t>> run() {
    std::vector<char> seen(corners_.size(), 0);
    charted_.assign(corners_.size(), 0);
    for (std::uint32_t t = 0; t < corners_.size(); ++t) {
      if (seen[t] != 0) continue;
      const auto piece = spread(t, [&](std::uint32_t u) { return std::exchange(seen[u], 1) == 0; });
      start_raster(piece);
      for (const std::uint32_t first : piece)
        if (charted_[first] == 0) {
          ++chart_;
          charts_.push_back(spread(first, [&](std::uint32_t u) { return claim(u); }));
        }
    }
    return std::move(charts_);
  }

 private:
  /// All that is reached from `first` over edges between triangles of one orientation, as far as `take` takes
  /// them.
  template <class Take>
  std::vector<std::uint32_t> spread(std::uint32_t first, const Take& take) const {
    std::vector<std::uint32_t> reached;
    if (take(first)) reached.push_back(first);
    const bool turned = doubled_area(corners_[first]) < 0;
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (const std::uint32_t next : beside_[reached[i]])
        if ((doubled_area(corners_[next]) < 0) == turned && take(next)) reached.push_back(next);
    return reached;
  }

  void start_raster(const std::vector<std::uint32_t>& piece) {
    Texel upper = corners_[piece[0]][0];
    lower_ = upper;
    for (const std::uint32_t t : piece)
      for (const Texel& corner : corners_[t])
        for (std::size_t c = 0; c < 2; ++c) {
          lower_[c] = std::min(lower_[c], corner[c]);
          upper[c] = std::max(upper[c], corner[c]);
        }
    const double area = (upper[0] - lower_[0] + 2) * (upper[1] - lower_[1] + 2);
    scale_ = std::min(1.0, std::sqrt(most_texels / area));
    for (double& x : lower_) x = std::floor(x);  // Whole, so that the texels are those of the layout.
    width_ = static_cast<std::size_t>(scale_ * (upper[0] - lower_[0])) + 2;
    const auto height = static_cast<std::size_t>(scale_ * (upper[1] - lower_[1])) + 2;
    chart_ = 0;
    owners_.assign(width_ * height, 0);
  }

  /// Puts a triangle into the chart that is growing, if it has none and its texels are free.
  bool claim(std::uint32_t t) {
    if (charted_[t] != 0) return false;
    std::array<Texel, 3> corners = corners_[t];
    for (Texel& corner : corners)
      for (std::size_t c = 0; c < 2; ++c) corner[c] = scale_ * (corner[c] - lower_[c]);
    const auto owner = [&](std::int64_t x, std::int64_t y) -> std::uint32_t& {
      return owners_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
    };
    bool is_free = true;
    for_each_texel(corners,
                   [&](std::int64_t x, std::int64_t y) { is_free = is_free && owner(x, y) != chart_; });
    if (!is_free) return false;
    for_each_texel(corners, [&](std::int64_t x, std::int64_t y) { owner(x, y) = chart_; });
    charted_[t] = 1;
    return true;
  }

  std::span<const std::array<Texel, 3>> corners_;
  std::span<const std::vector<std::uint32_t>> beside_;
  std::vector<std::vector<std::uint32_t>> charts_;
  std::vector<char> charted_;
  // Of the piece at hand:
  Texel lower_ = {};
  double scale_ = 1;
  std::size_t width_ = 0;
  std::uint32_t chart_ = 0;
  std::vector<std::uint32_t> owners_;  ///< The chart that last took each texel.
};

}  // namespace

std::vector<std::vector<std::uint32_t>> grow_charts(std::span<const ChartTriangle> triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> sides;
  const auto edge_of = [&](std::uint32_t t, std::size_t k) {
    return std::minmax({triangles[t].vertices[k], triangles[t].vertices[(k + 1) % 3]});
  };
  std::vector<std::array<Texel, 3>> corners;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    corners.push_back(triangles[t].corners);
    for (std::size_t k = 0; k < 3; ++k) sides[edge_of(t, k)].push_back(t);
  }
  std::vector<std::vector<std::uint32_t>> beside(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::uint32_t other : sides.at(edge_of(t, k)))
        if (other != t) beside[t].push_back(other);
  return grow_charts(corners, beside);
}

std::vector<std::vector<std::uint32_t>> grow_charts(std::span<const std::array<Texel, 3>> corners,
                                                    std::span<const std::vector<std::uint32_t>> beside) {
  return Grower(corners, beside).run();
}

}  // namespace applique
