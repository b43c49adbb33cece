#include <cmath>
#include <map>
#include <numbers>

#include "applique/image/draw.h"

#include "images.h"

namespace applique::assets {
namespace {

using namespace draw;

const Rgba paper{0.955, 0.915, 0.82};
const Rgba green{0.06, 0.24, 0.18};
const Rgba red{0.69, 0.16, 0.12};
const Rgba gold{0.76, 0.56, 0.22};

constexpr double pi = std::numbers::pi;

Outline arc(Vec2 centre, double radius, double from, double to) {
  Outline out;
  for (int i = 0; i <= 32; ++i) out.push_back(centre + std::polar(radius, from + (to - from) * i / 32));
  return out;
}

/// A letter's strokes in a cell one unit high (y down) and `width` wide.
struct Letter {
  double width;
  std::vector<Outline> strokes;
};

const std::map<char, Letter>& letters() {
  static const std::map<char, Letter> all{
      {'A', {0.84, {{{0, 1}, {0.42, 0}, {0.84, 1}}, {{0.18, 0.68}, {0.66, 0.68}}}}},
      {'D', {0.66, {[] {
               Outline o{{0, 0}, {0.16, 0}};
               for (const Vec2 p : arc({0.16, 0.5}, 0.5, -pi / 2, pi / 2)) o.push_back(p);
               o.insert(o.end(), {{0, 1}, {0, 0}});
               return o;
             }()}}},
      {'E', {0.5, {{{0.5, 0}, {0, 0}, {0, 1}, {0.5, 1}}, {{0, 0.5}, {0.42, 0.5}}}}},
      {'I', {0.0, {{{0, 0}, {0, 1}}}}},
      {'L', {0.46, {{{0, 0}, {0, 1}, {0.46, 1}}}}},
      {'O', {1.0, {arc({0.5, 0.5}, 0.5, 0, 2 * pi)}}},
      {'P', {0.54, {[] {
               Outline o{{0, 1}, {0, 0}, {0.26, 0}};
               for (const Vec2 p : arc({0.26, 0.28}, 0.28, -pi / 2, pi / 2)) o.push_back(p);
               o.push_back({0, 0.56});
               return o;
             }()}}},
      {'Q', {1.0, {arc({0.5, 0.5}, 0.5, 0, 2 * pi), {{0.62, 0.66}, {0.98, 1.06}}}}},
      {'R',
       {0.56,
        {[] {
           Outline o{{0, 1}, {0, 0}, {0.26, 0}};
           for (const Vec2 p : arc({0.26, 0.28}, 0.28, -pi / 2, pi / 2)) o.push_back(p);
           o.push_back({0, 0.56});
           return o;
         }(),
         {{0.26, 0.56}, {0.56, 1}}}}},
      {'S', {0.52, {[] {
               Outline o = arc({0.26, 0.255}, 0.255, -0.2 * pi, -1.5 * pi);
               for (const Vec2 p : arc({0.26, 0.755}, 0.245, -0.5 * pi, 0.8 * pi)) o.push_back(p);
               return o;
             }()}}},
      {'U', {0.66, {[] {
               Outline o{{0, 0}, {0, 0.67}};
               for (const Vec2 p : arc({0.33, 0.67}, 0.33, pi, 0)) o.push_back(p);
               o.push_back({0.66, 0});
               return o;
             }()}}},
      {'C', {0.8, {arc({0.5, 0.5}, 0.5, -0.28 * pi, -1.72 * pi)}}},
      {'N', {0.68, {{{0, 1}, {0, 0}, {0.68, 1}, {0.68, 0}}}}},
      {'T', {0.64, {{{0, 0}, {0.64, 0}}, {{0.32, 0}, {0.32, 1}}}}},
      {'V', {0.8, {{{0, 0}, {0.4, 1}, {0.8, 0}}}}},
      {' ', {0.3, {}}},
  };
  return all;
}

void write(Canvas& canvas, const std::string& text, Vec2 centre, double height, double spacing, double weight,
           const Paint& paint) {
  double width = -spacing;
  for (const char c : text) width += letters().at(c).width + spacing;
  double x = centre.real() - 0.5 * width * height;
  for (const char c : text) {
    const Letter& letter = letters().at(c);
    for (const Outline& stroke : letter.strokes) {
      Outline placed;
      for (const Vec2 p : stroke) placed.push_back(Vec2(x, centre.imag() - 0.5 * height) + height * p);
      canvas.line(placed, weight, paint);
    }
    x += (letter.width + spacing) * height;
  }
}

/// A rectangle whose corners are cut out in quarter circles.
Outline notched(double inset, double notch) {
  const double l = inset;
  const double t = inset;
  const double r = 1024 - inset;
  const double b = 512 - inset;
  Outline out;
  const auto corner = [&](Vec2 c, double from) {
    for (int i = 0; i <= 24; ++i) out.push_back(c + std::polar(notch, from - i / 24.0 * pi / 2));
  };
  corner({r, t}, pi);
  corner({r, b}, -pi / 2);
  corner({l, b}, 0);
  corner({l, t}, pi / 2);
  return out;
}

void paint_sunburst(Canvas& canvas, Vec2 c) {
  for (int i = 0; i < 48; ++i) {
    const double angle = i * pi / 24;
    canvas.stroke(std::vector<Dab>{{c + std::polar(100.0, angle), 2.4},
                                   {c + std::polar(i % 2 ? 118.0 : 128.0, angle), 0.9}},
                  solid(i % 2 ? gold : red));
  }
  canvas.fill(circle(c, 96), solid(green));
  canvas.line(circle(c, 89), 2.5, solid(gold), true);
  canvas.line(circle(c, 83), 1.2, solid(gold), true);
  // Three interlaced rings.
  for (int i = 0; i < 3; ++i) {
    const Vec2 ring = c + std::polar(24.0, -pi / 2 + i * 2 * pi / 3);
    canvas.line(circle(ring, 35), 10, solid(green), true);
    canvas.line(circle(ring, 35), 6,
                solid(i == 0   ? Rgba{0.96, 0.80, 0.42}
                      : i == 1 ? Rgba{0.93, 0.88, 0.76}
                               : Rgba{0.86, 0.34, 0.24}),
                true);
  }
}

}  // namespace

Image draw_label() {
  Canvas canvas(1024, 512);
  canvas.fill(notched(2, 46), solid(green));
  canvas.fill(notched(12, 44), solid(gold));
  canvas.fill(notched(17, 43),
              linear_gradient({0, 0}, {0, 512}, {{0.0, mix(paper, {1, 1, 1}, 0.4)}, {1.0, paper}}));
  // A frame of small diamonds between two lines.
  canvas.line(notched(30, 42), 2.5, solid(green), true);
  canvas.line(notched(54, 42), 1.6, solid(green), true);
  for (int i = 0; i < 2; ++i) {
    const double y = i == 0 ? 42 : 470;
    for (double x = 112; x <= 912; x += 25)
      canvas.fill(Outline{{x - 9, y}, {x, y - 7}, {x + 9, y}, {x, y + 7}},
                  solid(static_cast<int>(x - 112) / 25 % 2 ? gold : red));
    const double side = i == 0 ? 42 : 982;
    for (double step = 131; step <= 381; step += 25)
      canvas.fill(Outline{{side - 7, step}, {side, step - 9}, {side + 7, step}, {side, step + 9}},
                  solid(static_cast<int>(step - 131) / 25 % 2 ? gold : red));
  }
  paint_sunburst(canvas, {512, 190});
  for (const double side : {-1.0, 1.0}) {
    // Leaf sprays beside the medallion.
    const Vec2 root(512 + side * 172, 222);
    canvas.stroke(brush(std::vector<Dab>{
                      {root, 2.5}, {root + Vec2(side * 90, -34), 3}, {root + Vec2(side * 190, -20), 1}}),
                  solid(green));
    for (int i = 0; i < 7; ++i) {
      const double t = (i + 0.6) / 7.0;
      const Vec2 at = root + Vec2(side * 190 * t, -70 * t * (1.25 - t) - 4 * t);
      for (const double up : {-1.0, 1.0}) {
        const Vec2 along = Vec2(side * 30, up * 24) * (1.15 - 0.5 * t);
        Outline l{at};
        const Vec2 across = along * Vec2(0, 0.32);
        append_cubic(l, at + 0.3 * along + across, at + 0.75 * along + across, at + along);
        append_cubic(l, at + 0.75 * along - across, at + 0.3 * along - across, at);
        canvas.fill(l, solid(i % 2 ? green : Rgba{0.20, 0.42, 0.28}));
      }
    }
    canvas.fill(circle(root + Vec2(side * 206, -20), 7), solid(red));
  }
  write(canvas, "APPLIQUE", {512, 362}, 66, 0.36, 10, solid(green));
  canvas.line({{150, 424}, {330, 424}}, 2, solid(gold));
  canvas.line({{694, 424}, {874, 424}}, 2, solid(gold));
  write(canvas, "OLIVE OIL", {512, 424}, 25, 0.5, 3.6, solid(red));
  return canvas.image();
}

}  // namespace applique::assets
