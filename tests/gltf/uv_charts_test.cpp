#include "uv_charts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace applique {
namespace {

/// A strip of `cells` squares, two triangles each, whose columns of vertices lie where `place` puts them: it
/// is given the column and 0 for the lower side, 1 for the upper.
template <class Place>
std::vector<ChartTriangle> make_strip(std::uint32_t cells, const Place& place) {
  std::vector<ChartTriangle> strip;
  for (std::uint32_t i = 0; i < cells; ++i) {
    const std::array<std::uint32_t, 4> ids = {2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3};
    const std::array<Texel, 4> at = {place(i, 0), place(i, 1), place(i + 1, 0), place(i + 1, 1)};
    strip.push_back({{at[0], at[2], at[3]}, {ids[0], ids[2], ids[3]}});
    strip.push_back({{at[0], at[3], at[1]}, {ids[0], ids[3], ids[1]}});
  }
  return strip;
}

std::size_t count_triangles(const std::vector<std::vector<std::uint32_t>>& charts) {
  std::vector<std::uint32_t> all;
  for (const auto& chart : charts) all.insert(all.end(), chart.begin(), chart.end());
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end()) << "a triangle in two charts";
  return all.size();
}

TEST(GrowCharts, KeepsAPlaneTogether) {
  const auto strip = make_strip(20, [](std::uint32_t i, int side) {
    return Texel{7.3 * i - 40, 9.1 * side};
  });
  const auto charts = grow_charts(strip);
  EXPECT_EQ(charts.size(), 1u);
  EXPECT_EQ(count_triangles(charts), strip.size());
}

TEST(GrowCharts, CutsWhereItIsFolded) {
  const auto strip = make_strip(20, [](std::uint32_t i, int side) {
    return Texel{8 * std::abs(static_cast<double>(i) - 10), 16.0 * side};
  });
  const auto charts = grow_charts(strip);
  EXPECT_EQ(charts.size(), 2u);
  EXPECT_EQ(count_triangles(charts), strip.size());
}

TEST(GrowCharts, CutsWhereItOverlapsItself) {
  // One and a half turns of a ring.
  const auto strip = make_strip(48, [](std::uint32_t i, int side) {
    const double angle = i * std::numbers::pi / 16;
    const double radius = 40 + 20 * side;
    return Texel{radius * std::cos(angle), radius * std::sin(angle)};
  });
  const auto charts = grow_charts(strip);
  EXPECT_EQ(charts.size(), 2u);
  EXPECT_EQ(count_triangles(charts), strip.size());
  EXPECT_EQ(std::max(charts[0].size(), charts[1].size()), 64u) << "a full turn";
}

TEST(GrowCharts, ApartWithoutCommonVertices) {
  auto strip = make_strip(2, [](std::uint32_t i, int side) { return Texel{9.0 * i, 9.0 * side}; });
  for (std::size_t t = 2; t < 4; ++t)
    for (std::uint32_t& id : strip[t].vertices) id += 100;
  EXPECT_EQ(grow_charts(strip).size(), 2u);
}

TEST(GrowCharts, LooksAtHugeLayoutsCoarsely) {
  const auto strip = make_strip(10, [](std::uint32_t i, int side) { return Texel{1e6 * i, 1e6 * side}; });
  EXPECT_EQ(grow_charts(strip).size(), 1u);
}

}  // namespace
}  // namespace applique
