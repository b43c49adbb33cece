#include <cmath>
#include <numbers>

#include "applique/image/draw.h"

#include "images.h"

namespace applique::assets {
namespace {

using namespace draw;

const Rgba ink{0.10, 0.12, 0.20};
const Rgba cream{0.98, 0.95, 0.86};

/// Both sides of a curve, `half_width` away.
Outline band(const Outline& curve, double half_width) {
  Outline left, right;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2 along = curve[std::min(i + 1, curve.size() - 1)] - curve[i > 0 ? i - 1 : 0];
    const Vec2 across = half_width * along / std::abs(along) * Vec2(0, 1);
    left.push_back(curve[i] + across);
    right.push_back(curve[i] - across);
  }
  left.insert(left.end(), right.rbegin(), right.rend());
  return left;
}

/// A band along a curve: a rim, a field whose colour runs from one end to the other, beads down its middle.
Image draw_band(int width, int height, const Outline& curve, double half_width,
                const std::vector<Stop>& run) {
  Canvas canvas(width, height);
  canvas.fill(band(curve, half_width), solid(ink));
  canvas.fill(band(curve, half_width - 5), solid(cream));
  const Outline field = band(curve, half_width - 10);
  const auto colour_at = [&](Vec2 p) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < curve.size(); ++i)
      if (std::norm(curve[i] - p) < std::norm(curve[nearest] - p)) nearest = i;
    const double t = static_cast<double>(nearest) / static_cast<double>(curve.size() - 1);
    std::size_t stop = 1;
    while (stop + 1 < run.size() && run[stop].offset < t) ++stop;
    const Stop& a = run[stop - 1];
    const Stop& b = run[stop];
    return mix(a.colour, b.colour, (t - a.offset) / (b.offset - a.offset));
  };
  canvas.fill(field, colour_at);
  double walked = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double before = walked;
    walked += std::abs(curve[i] - curve[i - 1]);
    constexpr double spacing = 56;
    if (std::floor(walked / spacing) == std::floor(before / spacing)) continue;
    if (std::abs(curve.back() - curve[i]) < 0.5 * spacing) break;
    const bool large = static_cast<int>(walked / spacing) % 2 == 0;
    canvas.fill(circle(curve[i], large ? 13 : 7), solid(cream));
    if (large) canvas.fill(circle(curve[i], 7), solid(ink));
  }
  return canvas.image();
}

const std::vector<Stop> sunset = {{0.0, {0.12, 0.28, 0.55}},
                                  {0.35, {0.42, 0.30, 0.62}},
                                  {0.7, {0.87, 0.37, 0.36}},
                                  {1.0, {0.96, 0.69, 0.25}}};
const std::vector<Stop> forest = {
    {0.0, {0.05, 0.32, 0.30}}, {0.5, {0.18, 0.55, 0.38}}, {1.0, {0.78, 0.78, 0.30}}};

}  // namespace

Pixel snake_point(double t) {
  return {80 + 864 * t, 256 - 150 * std::sin(3 * std::numbers::pi * t)};
}

Image draw_snake() {
  std::vector<Vec2> points;
  for (int i = 0; i <= 24; ++i) {
    const Pixel p = snake_point(i / 24.0);
    points.emplace_back(p.x, p.y);
  }
  return draw_band(1024, 512, spline(points, false, 12), 58, sunset);
}

Image draw_horseshoe() {
  Outline curve;
  for (int i = 0; i <= 40; ++i) curve.emplace_back(150, 80 + 300.0 * i / 40);
  for (int i = 1; i < 80; ++i)
    curve.push_back(Vec2(384, 380) + std::polar(234.0, std::numbers::pi * (1 - i / 80.0)));
  for (int i = 0; i <= 40; ++i) curve.emplace_back(618, 380 - 300.0 * i / 40);
  return draw_band(768, 700, curve, 66, forest);
}

Image draw_belt() {
  Outline curve;
  for (int i = 0; i <= 160; ++i) curve.emplace_back(24 + 1952.0 * i / 160, 100);
  return draw_band(2000, 200, curve, 72, sunset);
}

Image draw_star() {
  constexpr Vec2 centre(320, 330);
  const double up = -std::numbers::pi / 2;
  Canvas canvas(640, 640);
  canvas.fill(star(centre, 305, 150, 5, up), solid(ink));
  canvas.fill(star(centre, 288, 141, 5, up), solid(cream));
  const Outline field = star(centre, 270, 132, 5, up);
  for (std::size_t i = 0; i < field.size(); ++i)
    canvas.fill(Outline{centre, field[i], field[(i + 1) % field.size()]},
                solid(i % 2 == 0 ? Rgba{0.83, 0.26, 0.20} : Rgba{0.96, 0.60, 0.22}));
  canvas.fill(circle(centre, 66), solid(ink));
  canvas.fill(circle(centre, 56), solid(cream));
  canvas.fill(circle(centre, 40), solid({0.12, 0.28, 0.55}));
  return canvas.image();
}

}  // namespace applique::assets
