#include "compare/layouts.h"

#include <cmath>
#include <numbers>

#include "applique/image/draw.h"

namespace applique::compare {
namespace {

constexpr Vec2 middle(image_size / 2.0, image_size / 2.0);

Region region_of(const draw::Outline& outline) {
  std::vector<Pixel> contour;
  for (const Vec2 p : outline) contour.push_back({p.real(), p.imag()});
  return Region::from_contour(contour, ImageFrame{image_size, image_size}).value();
}

/// A place around the middle, pixels and degrees counter-clockwise from the right.
Pixel around(double radius, double degrees) {
  const Vec2 p = middle + std::polar(radius, -degrees * std::numbers::pi / 180);
  return {p.real(), p.imag()};
}

/// No three pins lie on a line, as none do that are put by hand.
Layout disc() {
  constexpr double inner = 150, outer = 190;
  return {"disc",
          region_of(draw::circle(middle, disc_radius)),
          {around(0, 0), around(inner, 8), around(inner, 173), around(inner, 97), around(inner, 262),
           around(outer, 48), around(outer, 131), around(outer, 222), around(outer, 317)}};
}

/// Pins near the tips, then between them; no three on a line.
Layout star() {
  constexpr double outer = 250, inner = 115, tip = 180, notch = 85;
  constexpr double upright = -std::numbers::pi / 2;
  return {"star",
          region_of(draw::star(middle, outer, inner, 5, upright)),
          {around(0, 0), around(tip, 90), around(tip, 18), around(tip, 162), around(tip, 234),
           around(tip, 306), around(notch, 262), around(notch, 60), around(notch, 120)}};
}

Layout strip() {
  constexpr Vec2 half(240, 56);
  constexpr double radius = 40;
  const auto along = [](double x) { return Pixel{middle.real() + x, middle.imag()}; };
  return {"strip",
          region_of(draw::rounded_rectangle(middle - half, middle + half, radius)),
          {along(0), along(200), along(-200), along(100), along(-100), along(150), along(-150), along(50),
           along(-50)}};
}

}  // namespace

std::vector<Layout> all_layouts() {
  return {disc(), star(), strip()};
}

}  // namespace applique::compare
