#include <cmath>
#include <numbers>

#include "applique/image/draw.h"

#include "images.h"

namespace applique::assets {
namespace {

using namespace draw;

constexpr double axis = 384;  // the emblem's middle
const Rgba navy{0.06, 0.13, 0.30};
const Rgba navy_light{0.16, 0.30, 0.58};
const Rgba red{0.70, 0.12, 0.14};
const Rgba ink{0.05, 0.05, 0.08};

Paint gold() {
  return linear_gradient({150, 60}, {620, 720},
                         {{0.0, {1.0, 0.90, 0.58}},
                          {0.3, {0.80, 0.57, 0.20}},
                          {0.5, {1.0, 0.93, 0.66}},
                          {0.75, {0.74, 0.50, 0.16}},
                          {1.0, {0.96, 0.82, 0.46}}});
}

/// The shield, `inset` pixels inside its rim.
Outline shield(double inset) {
  const double left = 204 + inset;
  const double right = 564 - inset;
  const double top = 150 + inset;
  Outline out{{left, top}};
  append_cubic(out, {left + 60, top + 22}, {axis - 60, top + 14}, {axis, top - 22});
  append_cubic(out, {axis + 60, top + 14}, {right - 60, top + 22}, {right, top});
  append_cubic(out, {right + 14, 330}, {right - 10, 470 - inset * 0.6}, {axis, 602 - 1.25 * inset});
  append_cubic(out, {left + 10, 470 - inset * 0.6}, {left - 14, 330}, {left, top});
  return out;
}

Outline leaf(Vec2 root, double angle, double length) {
  const Vec2 along = std::polar(length, angle);
  const Vec2 across = along * Vec2(0, 0.27);
  Outline out{root};
  append_cubic(out, root + 0.25 * along + across, root + 0.75 * along + across, root + along);
  append_cubic(out, root + 0.75 * along - across, root + 0.25 * along - across, root);
  return out;
}

void paint_laurel(Canvas& canvas, bool left) {
  const auto side = [&](const Outline& o) { return left ? o : mirrored(o, axis); };
  const Vec2 centre(axis, 388);
  const auto on_branch = [&](double t) {
    return centre + std::polar(300.0, std::numbers::pi * (0.5 - 0.76 * t));
  };
  std::vector<Dab> stem;
  for (int i = 0; i <= 24; ++i) stem.push_back({on_branch(i / 24.0), 6.5 - 4.5 * i / 24.0});
  const auto draw_stem = [&](double extra, const Paint& paint) {
    auto dabs = stem;
    for (Dab& dab : dabs) dab.half_width += extra;
    canvas.stroke(left ? dabs : mirrored(dabs, axis), paint);
  };
  std::vector<Outline> leaves;
  for (int i = 1; i <= 12; ++i) {
    const double t = i / 12.4;
    const Vec2 root = on_branch(t);
    const double heading = std::numbers::pi * (0.5 - 0.76 * t) - std::numbers::pi / 2;
    const double length = 88 - 26 * t;
    leaves.push_back(side(leaf(root, heading + 0.62, length)));
    leaves.push_back(side(leaf(root, heading - 0.62, length)));
  }
  leaves.push_back(side(leaf(on_branch(1), std::numbers::pi * -0.26 - std::numbers::pi / 2, 66)));
  for (const Outline& l : leaves) canvas.line(l, 9, solid(ink), true);
  draw_stem(4, solid(ink));
  for (const Outline& l : leaves) {
    const Vec2 tip = l[24];
    canvas.fill(l, linear_gradient(l.front(), tip, {{0.0, {0.10, 0.33, 0.17}}, {1.0, {0.42, 0.66, 0.30}}}));
    canvas.stroke(std::vector<Dab>{{l.front(), 2.2}, {l.front() + 0.86 * (tip - l.front()), 0.5}},
                  solid({0.85, 0.90, 0.55, 0.8}));
  }
  draw_stem(0, gold());
}

void paint_star(Canvas& canvas, Vec2 c, double radius) {
  const double up = -std::numbers::pi / 2;
  canvas.fill(star(c, radius * 1.13, radius * 0.53, 5, up), solid(with_alpha(ink, 0.55)));
  const Outline points = star(c, radius, radius * 0.44, 5, up);
  // Each ray has a lit and a shaded facet.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Outline facet{c, points[i], points[(i + 1) % points.size()]};
    canvas.line(facet, 1, solid({0.75, 0.52, 0.18}), true);
    canvas.fill(facet, solid(i % 2 == 0 ? Rgba{0.78, 0.54, 0.17} : Rgba{1.0, 0.92, 0.62}));
  }
}

}  // namespace

Image draw_emblem() {
  Canvas canvas(768, 768);
  paint_laurel(canvas, true);
  paint_laurel(canvas, false);
  // Shield: rim, field parted by a chevron of red, star and stripes.
  canvas.fill(shield(-7), solid(ink));
  canvas.fill(shield(0), gold());
  canvas.fill(shield(17), solid(ink));
  const Outline field = shield(21);
  canvas.fill(field, radial_gradient({axis, 290}, 320, {{0.0, navy_light}, {1.0, navy}}));
  canvas.begin_clip(std::span(&field, 1));
  for (int i = -9; i <= 9; ++i)
    canvas.line({{axis + 40.0 * i - 300, 100}, {axis + 40.0 * i + 300, 700}}, 1.2,
                solid({0.6, 0.75, 1.0, 0.16}));
  const auto chevron = [&](double top, double thickness, const Paint& paint) {
    canvas.fill(Outline{{axis, top},
                        {axis + 260, top + 180},
                        {axis + 260, top + 180 + thickness},
                        {axis, top + thickness},
                        {axis - 260, top + 180 + thickness},
                        {axis - 260, top + 180}},
                paint);
  };
  chevron(402, 92, gold());
  chevron(413, 70, linear_gradient({axis, 410}, {axis, 600}, {{0.0, red}, {1.0, {0.42, 0.05, 0.08}}}));
  chevron(438, 18, gold());
  canvas.end_clip();
  canvas.line(field, 2.5, solid(with_alpha(ink, 0.8)), true);
  paint_star(canvas, {axis, 302}, 106);
  for (const double side : {-1.0, 1.0}) paint_star(canvas, {axis + side * 122, 222}, 26);
  // Crown: five points with pearls over a band.
  const Outline crown{{axis - 104, 128}, {axis - 124, 42}, {axis - 66, 84},  {axis - 56, 22},
                      {axis - 24, 74},   {axis, 8},        {axis + 24, 74},  {axis + 56, 22},
                      {axis + 66, 84},   {axis + 124, 42}, {axis + 104, 128}};
  canvas.line(crown, 14, solid(ink), true);
  canvas.fill(crown, gold());
  canvas.fill(rounded_rectangle({axis - 108, 112}, {axis + 108, 142}, 8), solid(ink));
  canvas.fill(
      rounded_rectangle({axis - 103, 117}, {axis + 103, 137}, 6),
      linear_gradient({axis, 117}, {axis, 137}, {{0.0, {0.86, 0.22, 0.24}}, {1.0, {0.5, 0.05, 0.1}}}));
  for (int i = -2; i <= 2; ++i) canvas.fill(circle({axis + 40.0 * i, 127}, 6.5), gold());
  const Vec2 tips[] = {{axis - 124, 42}, {axis - 56, 22}, {axis, 12}, {axis + 56, 22}, {axis + 124, 42}};
  for (const Vec2 tip : tips) {
    canvas.fill(circle(tip, 12), solid(ink));
    canvas.fill(circle(tip, 9),
                radial_gradient(tip - Vec2(3, 3), 12, {{0.0, {1, 1, 1}}, {1.0, {0.78, 0.74, 0.72}}}));
  }
  // Ribbon that ties the laurel.
  for (const double side : {-1.0, 1.0}) {
    const auto at = [&](double x, double y) { return Vec2(axis + side * x, y); };
    const Outline tail{at(8, 676), at(118, 704), at(100, 722), at(126, 742), at(10, 716)};
    canvas.line(tail, 9, solid(ink), true);
    canvas.fill(tail, linear_gradient(
                          at(0, 690), at(126, 720),
                          {{0.0, {0.45, 0.05, 0.08}}, {0.5, {0.80, 0.18, 0.18}}, {1.0, {0.55, 0.07, 0.1}}}));
  }
  canvas.fill(circle({axis, 692}, 30), solid(ink));
  canvas.fill(circle({axis, 692}, 25), gold());
  canvas.fill(circle({axis, 692}, 17), solid(red));
  paint_star(canvas, {axis, 693}, 12);
  return canvas.image();
}

}  // namespace applique::assets
