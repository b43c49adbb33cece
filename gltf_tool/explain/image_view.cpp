#include "explain/image_view.h"

#include <algorithm>
#include <cmath>

#include "explain/digits.h"
#include "explain/palette.h"

namespace applique {
namespace {

using namespace draw;

constexpr double outside_share = 0.3;  // of the strength inside the region

}  // namespace

Pen pen_for(const Box& box) {
  const double unit = std::min(box.size.real(), box.size.imag()) / 400;
  return {std::max(0.6, 0.9 * unit), std::max(1.2, 1.8 * unit), std::max(2.0, 3.2 * unit),
          std::max(5.5, 9 * unit)};
}

PlaneView view_of_image(const SolvedDecal& decal, const Box& box) {
  const ImageFrame& frame = decal.region.frame();
  const std::vector<Vec2> corners = {frame.to_plane({0, 0}), frame.to_plane({frame.width, frame.height})};
  return fit(corners, box);
}

Rgba sample_image(const Image& image, Pixel at, double footprint) {
  const double half = 0.5 * std::max(footprint, 1.0);
  const auto first = [&](double middle) { return static_cast<int>(std::floor(middle - half + 0.5)); };
  const auto count = std::max(1, static_cast<int>(std::lround(2 * half)));
  const int x0 = first(at.x), y0 = first(at.y);
  double red = 0, green = 0, blue = 0, alpha = 0;
  for (int y = std::max(0, y0); y < std::min(image.height, y0 + count); ++y)
    for (int x = std::max(0, x0); x < std::min(image.width, x0 + count); ++x) {
      const std::uint16_t* p = image.pixel(x, y);
      const double a = p[3] / 65535.0;
      red += a * p[0];
      green += a * p[1];
      blue += a * p[2];
      alpha += a;
    }
  if (alpha <= 0) return {0, 0, 0, 0};
  const double scale = 1 / (65535.0 * alpha);
  return {red * scale, green * scale, blue * scale, alpha / (static_cast<double>(count) * count)};
}

void draw_image(Canvas& canvas, const SolvedDecal& decal, const PlaneView& view, double strength) {
  const ImageFrame& frame = decal.region.frame();
  const Outline border =
      view(std::vector<Vec2>{frame.to_plane({0, 0}), frame.to_plane({frame.width, 0}),
                             frame.to_plane({frame.width, frame.height}), frame.to_plane({0, frame.height})});
  const double footprint = frame.pixels_per_unit() / view.scale;
  const auto paint = [&](double share) {
    return [&, share](Vec2 p) {
      Rgba colour = sample_image(decal.image, frame.to_pixel(view.to_plane(p)), footprint);
      colour.a *= share;
      return colour;
    };
  };
  const Outline contour = view(decal.region.polygon());
  const Outline outside[] = {border, contour};
  canvas.fill(outside, paint(outside_share * strength));
  canvas.fill(contour, paint(strength));
}

void draw_contour(Canvas& canvas, std::span<const Vec2> contour, const PlaneView& view, double width) {
  canvas.line(view(contour), width, solid(palette::vermilion), true);
}

void draw_feature(Canvas& canvas, Vec2 at, std::size_t number, double radius, const Rgba& colour) {
  canvas.fill(circle(at, 1.18 * radius), solid(with_alpha(palette::white, colour.a)));
  canvas.fill(circle(at, radius), solid(colour));
  const double digits = number < 10 ? 1.05 : 0.85;
  draw_number(canvas, number, at, digits * radius, solid(with_alpha(palette::white, colour.a)));
}

void draw_features(Canvas& canvas, std::span<const Vec2> features, const PlaneView& view, const Pen& pen,
                   std::span<const std::uint32_t> groups) {
  for (std::size_t k = 0; k < features.size(); ++k)
    draw_feature(canvas, view(features[k]), k, pen.mark,
                 groups.empty() ? palette::ink : mix(palette::group(groups[k]), palette::ink, 0.25));
}

void draw_pairs(Canvas& canvas, std::span<const Vec2> features, std::span<const FeaturePair> pairs,
                const PlaneView& view, double width, const Rgba& colour) {
  for (const auto& [i, j] : pairs) canvas.line({view(features[i]), view(features[j])}, width, solid(colour));
}

std::vector<Vec2> targets_of(const SolvedDecal& decal) {
  std::vector<Vec2> targets;
  for (const Feature& feature : decal.features)
    targets.push_back(decal.region.frame().to_plane(feature.image));
  return targets;
}

}  // namespace applique
