#include <cmath>
#include <numbers>

#include "applique/image/draw.h"

#include "images.h"

namespace applique::assets {
namespace {

using namespace draw;

constexpr double axis = 512;  // the mask's middle
const Rgba ivory{0.96, 0.91, 0.82};
const Rgba ivory_shade{0.83, 0.70, 0.56};
const Rgba crimson{0.62, 0.08, 0.15};
const Rgba crimson_dark{0.36, 0.03, 0.09};
const Rgba teal{0.05, 0.38, 0.42};
const Rgba teal_dark{0.02, 0.19, 0.24};
const Rgba ink{0.07, 0.06, 0.09};

/// Hammered gold: a gradient that shines twice across the picture.
Paint gold() {
  return linear_gradient({180, 60}, {840, 960},
                         {{0.0, {0.98, 0.86, 0.52}},
                          {0.22, {0.80, 0.56, 0.18}},
                          {0.42, {1.0, 0.92, 0.64}},
                          {0.62, {0.72, 0.47, 0.13}},
                          {0.85, {0.97, 0.83, 0.47}},
                          {1.0, {0.75, 0.50, 0.16}}});
}

/// Both halves of a symmetric outline from its left one (the image's right), given from the top down.
Outline both_sides(const Outline& half) {
  Outline whole = half;
  const Outline other = mirrored(half, axis);
  whole.insert(whole.end(), other.rbegin(), other.rend());
  return whole;
}

Outline mask_outline() {
  Outline half{{512, 12}};
  append_cubic(half, {530, 62}, {552, 96}, {588, 122});  // crown of flames
  append_cubic(half, {622, 104}, {648, 78}, {664, 40});
  append_cubic(half, {682, 90}, {704, 122}, {742, 146});
  append_cubic(half, {776, 136}, {800, 118}, {820, 92});
  append_cubic(half, {828, 144}, {842, 184}, {874, 222});
  append_cubic(half, {906, 222}, {930, 212}, {952, 194});
  append_cubic(half, {940, 262}, {922, 330}, {930, 400});
  append_cubic(half, {938, 450}, {962, 490}, {996, 520});  // wing at the cheekbone
  append_cubic(half, {950, 540}, {914, 566}, {890, 616});
  append_cubic(half, {868, 690}, {836, 780}, {768, 850});
  append_cubic(half, {700, 920}, {620, 980}, {512, 1010});
  return both_sides(half);
}

/// The ivory middle: brow, nose, mouth and chin.
Outline face_panel() {
  Outline half{{512, 300}};
  append_cubic(half, {536, 340}, {556, 372}, {572, 400});
  append_cubic(half, {566, 470}, {560, 540}, {604, 610});
  append_cubic(half, {640, 660}, {722, 690}, {740, 770});
  append_cubic(half, {748, 840}, {660, 930}, {512, 972});
  return both_sides(half);
}

Outline eye_opening(double grow) {
  const Vec2 inner(604 - 1.5 * grow, 442 + 0.3 * grow);
  const Vec2 outer(774 + 1.9 * grow, 416 - 0.9 * grow);
  Outline eye{inner};
  append_cubic(eye, Vec2(636, 386 - 1.2 * grow), Vec2(712, 364 - 1.2 * grow), outer);
  append_cubic(eye, Vec2(742, 470 + 1.2 * grow), Vec2(660, 484 + 1.2 * grow), inner);
  return eye;
}

void paint_lattice(Canvas& canvas, const Outline& outline) {
  canvas.begin_clip(std::span(&outline, 1));
  constexpr double w = 46;  // half a diamond
  constexpr double h = 66;
  for (int row = -1; row < 18; ++row)
    for (int column = -12; column <= 12; ++column) {
      if ((row + column) % 2 != 0) continue;
      // Diamonds lean outwards from the middle like cloth over a face.
      const double x = axis + column * w;
      const double y = 40 + row * h + 0.00022 * (x - axis) * (x - axis);
      const bool left = column > 0 || (column == 0 && row % 4 == 0);
      const Outline diamond{{x, y - h}, {x + w, y}, {x, y + h}, {x - w, y}};
      const bool light = ((row - column) / 2) % 2 == 0;
      const Rgba base = left ? (light ? teal : teal_dark) : (light ? crimson : crimson_dark);
      canvas.fill(diamond, linear_gradient({x - w, y - h}, {x + w, y + h},
                                           {{0.0, mix(base, ivory, 0.14)}, {1.0, base}}));
    }
  for (int row = -1; row < 18; ++row)
    for (int column = -12; column <= 12; ++column) {
      if ((row + column) % 2 != 0) continue;
      const double x = axis + column * w;
      const double y = 40 + row * h + 0.00022 * (x - axis) * (x - axis);
      canvas.line({{x, y - h}, {x + w, y}, {x, y + h}, {x - w, y}}, 2.6, gold(), true);
      canvas.fill(circle({x, y - h}, 6.5), gold());
    }
  canvas.end_clip();
}

/// A scroll that curls in at its end.
std::vector<Dab> scroll(Vec2 start, Vec2 bend, Vec2 centre, double radius, double turn, double thickness) {
  std::vector<Dab> dabs{{start, 1.0}, {bend, thickness}};
  const double from = std::arg(bend - centre) + turn * 0.9;
  for (int i = 0; i <= 10; ++i) {
    const double share = i / 10.0;
    dabs.push_back({centre + std::polar(radius * (1 - 0.8 * share), from + turn * 5.2 * share),
                    thickness * (1 - 0.65 * share)});
  }
  return brush(dabs, 8);
}

void paint_both(Canvas& canvas, const std::vector<Dab>& dabs, const Paint& paint) {
  canvas.stroke(dabs, paint);
  canvas.stroke(mirrored(dabs, axis), paint);
}

void paint_face(Canvas& canvas) {
  const Outline panel = face_panel();
  canvas.line(panel, 26, solid(with_alpha(ink, 0.35)), true);
  canvas.fill(panel,
              radial_gradient({512, 640}, 380, {{0.0, {1.0, 0.97, 0.90}}, {0.6, ivory}, {1.0, ivory_shade}}));
  canvas.begin_clip(std::span(&panel, 1));
  // The nose: shade along its flanks and under the tip.
  for (const double side : {-1.0, 1.0}) {
    const auto x = [&](double offset) { return axis + side * offset; };
    canvas.stroke(
        brush(std::vector<Dab>{{{x(44), 400}, 2}, {{x(40), 500}, 8}, {{x(62), 610}, 14}, {{x(70), 650}, 3}}),
        solid({0.66, 0.48, 0.36, 0.30}));
    canvas.stroke(
        brush(std::vector<Dab>{{{x(78), 628}, 2}, {{x(88), 652}, 5}, {{x(66), 672}, 5}, {{x(36), 666}, 1}}),
        solid({0.45, 0.25, 0.18, 0.75}));
    // Cheek bloom.
    canvas.fill(circle({x(190), 740}, 90),
                radial_gradient({x(190), 740}, 90,
                                {{0.0, {0.80, 0.25, 0.22, 0.45}}, {1.0, {0.80, 0.25, 0.22, 0.0}}}));
  }
  canvas.stroke(brush(std::vector<Dab>{{{512, 350}, 2}, {{512, 480}, 10}, {{512, 600}, 17}, {{512, 640}, 8}}),
                solid({1.0, 0.99, 0.95, 0.75}));
  canvas.end_clip();
  canvas.line(panel, 9, gold(), true);
  canvas.line(panel, 1.6, solid(with_alpha(ink, 0.7)), true);
}

void paint_lips(Canvas& canvas) {
  Outline upper_half{{512, 776}};
  append_cubic(upper_half, {526, 760}, {548, 758}, {566, 768});
  append_cubic(upper_half, {596, 778}, {622, 794}, {652, 808});
  append_cubic(upper_half, {610, 812}, {560, 808}, {512, 812});
  Outline lower_half{{512, 811}};
  append_cubic(lower_half, {560, 806}, {610, 812}, {652, 808});
  append_cubic(lower_half, {620, 850}, {570, 868}, {512, 868});
  canvas.fill(
      both_sides(lower_half),
      linear_gradient({512, 806}, {512, 870},
                      {{0.0, {0.52, 0.04, 0.09}}, {0.45, {0.84, 0.16, 0.20}}, {1.0, {0.58, 0.06, 0.11}}}));
  canvas.fill(
      both_sides(upper_half),
      linear_gradient({512, 760}, {512, 812}, {{0.0, {0.74, 0.12, 0.17}}, {1.0, {0.42, 0.03, 0.08}}}));
  paint_both(
      canvas,
      brush(std::vector<Dab>{{{512, 811}, 3.2}, {{580, 808}, 2.6}, {{654, 807}, 1.2}, {{668, 800}, 0.8}}),
      solid(ink));
  canvas.stroke(brush(std::vector<Dab>{{{478, 838}, 1}, {{500, 842}, 5}, {{530, 841}, 4}, {{552, 836}, 1}}),
                solid({1, 0.85, 0.82, 0.55}));
}

void paint_eyes(Canvas& canvas) {
  for (const bool left : {true, false}) {
    const auto side = [&](const Outline& outline) { return left ? outline : mirrored(outline, axis); };
    canvas.fill(side(eye_opening(34)), solid(with_alpha(ink, 0.35)));
    canvas.fill(side(eye_opening(29)), gold());
    canvas.fill(side(eye_opening(22)), solid(ink));
    canvas.line(side(eye_opening(8)), 3, gold(), true);
    const Outline hole = side(eye_opening(0));
    canvas.erase(std::span(&hole, 1));
  }
  // Brows, a flick beyond the eye's corner, and a tear.
  paint_both(canvas,
             brush(std::vector<Dab>{
                 {{566, 366}, 2}, {{620, 318}, 12}, {{700, 296}, 13}, {{790, 306}, 8}, {{862, 280}, 1}}),
             solid(ink));
  paint_both(canvas,
             brush(std::vector<Dab>{
                 {{574, 362}, 1}, {{622, 320}, 5}, {{700, 297}, 6}, {{786, 305}, 3}, {{850, 284}, 0.6}}),
             gold());
  paint_both(canvas, brush(std::vector<Dab>{{{806, 408}, 8}, {{846, 390}, 6}, {{884, 350}, 1}}), solid(ink));
  paint_both(canvas, brush(std::vector<Dab>{{{800, 430}, 6}, {{842, 430}, 4}, {{880, 412}, 1}}), solid(ink));
  const Outline tear{{690, 510}, {710, 560}, {690, 622}, {670, 560}};
  canvas.fill(tear, solid(ink));
  canvas.fill(Outline{{690, 530}, {700, 560}, {690, 600}, {680, 560}}, gold());
}

void paint_jewel(Canvas& canvas) {
  const Vec2 c(512, 205);
  for (int i = 0; i < 16; ++i) {
    const double angle = (i + 0.5) * std::numbers::pi / 8;
    const double reach = i % 2 == 0 ? 104 : 84;
    canvas.stroke(std::vector<Dab>{{c + std::polar(50.0, angle), 7}, {c + std::polar(reach, angle), 0.8}},
                  gold());
  }
  const Outline setting{c + Vec2(0, -74), c + Vec2(50, 0), c + Vec2(0, 74), c + Vec2(-50, 0)};
  const Outline gem{c + Vec2(0, -60), c + Vec2(39, 0), c + Vec2(0, 60), c + Vec2(-39, 0)};
  canvas.fill(setting, gold());
  canvas.line(setting, 3, solid(with_alpha(ink, 0.8)), true);
  canvas.fill(gem, solid({0.03, 0.34, 0.22}));
  canvas.fill(Outline{gem[0], gem[1], c}, solid({0.20, 0.68, 0.45}));
  canvas.fill(Outline{gem[0], gem[3], c}, solid({0.50, 0.90, 0.68}));
  canvas.fill(Outline{gem[2], gem[3], c}, solid({0.08, 0.50, 0.32}));
  canvas.line(gem, 2, solid(with_alpha(ink, 0.7)), true);
}

}  // namespace

Image draw_mask() {
  Canvas canvas(1024, 1024);
  const Outline outline = mask_outline();
  canvas.fill(outline, solid(teal_dark));
  paint_lattice(canvas, outline);
  // The cloth darkens towards the rim.
  canvas.begin_clip(std::span(&outline, 1));
  canvas.fill(outline,
              radial_gradient({512, 520}, 560, {{0.55, with_alpha(ink, 0.0)}, {1.0, with_alpha(ink, 0.55)}}));
  canvas.end_clip();
  paint_face(canvas);
  paint_lips(canvas);
  paint_eyes(canvas);
  paint_jewel(canvas);
  paint_both(canvas, scroll({610, 250}, {680, 226}, {742, 236}, 34, 1, 7), gold());
  paint_both(canvas, scroll({800, 700}, {850, 620}, {842, 556}, 36, -1, 7), gold());
  // The rim: gold, drawn inside the outline.
  canvas.begin_clip(std::span(&outline, 1));
  canvas.line(outline, 54, solid(with_alpha(ink, 0.85)), true);
  canvas.line(outline, 44, gold(), true);
  canvas.line(outline, 14, solid({0.55, 0.34, 0.08}), true);
  canvas.line(outline, 8, gold(), true);
  canvas.end_clip();
  return canvas.image();
}

}  // namespace applique::assets
