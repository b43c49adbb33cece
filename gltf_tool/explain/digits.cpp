#include "explain/digits.h"

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace applique {
namespace {

using namespace draw;

constexpr double pi = std::numbers::pi;
constexpr double digit_width = 0.56;  // of the height
constexpr double spacing = 0.24;
constexpr double weight = 0.14;

/// A digit's strokes in a cell one unit high (y down).
using Strokes = std::vector<Outline>;

/// Part of an ellipse about `centre`; angles grow clockwise on the screen, from the right.
void append_arc(Outline& line, Vec2 centre, Vec2 radii, double from, double to) {
  constexpr int steps = 16;
  for (int i = 0; i <= steps; ++i) {
    const double angle = from + (to - from) * i / steps;
    line.push_back(centre + Vec2(radii.real() * std::cos(angle), radii.imag() * std::sin(angle)));
  }
}

std::array<Strokes, 10> make_digits() {
  std::array<Strokes, 10> digits;
  const Vec2 upper(0.28, 0.26), lower(0.28, 0.72), upper_radii(0.23, 0.26), lower_radii(0.28, 0.28);
  Outline zero, two, three, five, six, eight_top, eight_bottom, nine;
  append_arc(zero, {0.28, 0.5}, {0.28, 0.5}, 0, 2 * pi);
  append_arc(two, {0.28, 0.28}, {0.27, 0.28}, -pi, 0.2 * pi);
  two.insert(two.end(), {{0.0, 1.0}, {0.56, 1.0}});
  append_arc(three, upper, upper_radii, -0.9 * pi, 0.5 * pi);
  append_arc(three, lower, lower_radii, -0.5 * pi, 0.9 * pi);
  five = {{0.5, 0.0}, {0.09, 0.0}, {0.05, 0.47}};
  append_arc(five, {0.27, 0.68}, {0.29, 0.32}, -0.75 * pi, 0.85 * pi);
  six.emplace_back(0.44, 0.0);
  append_arc(six, {0.28, 0.69}, {0.28, 0.31}, -pi, pi);
  append_arc(eight_top, upper, upper_radii, 0, 2 * pi);
  append_arc(eight_bottom, lower, lower_radii, 0, 2 * pi);
  nine.emplace_back(0.12, 1.0);
  append_arc(nine, {0.28, 0.31}, {0.28, 0.31}, 0, -2 * pi);
  digits[0] = {zero};
  digits[1] = {{{0.1, 0.2}, {0.34, 0.0}, {0.34, 1.0}}};
  digits[2] = {two};
  digits[3] = {three};
  digits[4] = {{{0.42, 1.0}, {0.42, 0.0}, {0.0, 0.7}, {0.58, 0.7}}};
  digits[5] = {five};
  digits[6] = {six};
  digits[7] = {{{0.0, 0.0}, {0.56, 0.0}, {0.18, 1.0}}};
  digits[8] = {eight_top, eight_bottom};
  digits[9] = {nine};
  return digits;
}

/// Digits and points, from their upper left corner on.
void draw_text(Canvas& canvas, const std::string& text, Vec2 corner, double height, const Paint& paint) {
  static const std::array<Strokes, 10> digits = make_digits();
  static const Strokes point = {{{0, 0.95}, {0, 1}}};
  for (const char letter : text) {
    for (const Outline& stroke : letter == '.' ? point : digits[static_cast<std::size_t>(letter - '0')]) {
      Outline line;
      for (const Vec2 p : stroke) line.push_back(corner + height * p);
      canvas.line(line, weight * height, paint);
    }
    corner += height * ((letter == '.' ? 0 : digit_width) + spacing);
  }
}

}  // namespace

void draw_number(Canvas& canvas, std::size_t number, Vec2 centre, double height, const Paint& paint) {
  const std::string text = std::to_string(number);
  const double width = static_cast<double>(text.size()) * (digit_width + spacing) - spacing;
  draw_text(canvas, text, centre - 0.5 * height * Vec2(width, 1), height, paint);
}

void draw_decimal(Canvas& canvas, double number, Vec2 start, double height, const Paint& paint) {
  draw_text(canvas, fmt::format("{:.2f}", number), start - Vec2(0, 0.5 * height), height, paint);
}

}  // namespace applique
