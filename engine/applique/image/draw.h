#pragma once

#include <functional>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/image/image.h"

/// A small vector painter: shapes given by their outlines or strokes, filled with anti-aliased edges. Pixels,
/// y down; points are complex numbers (x + iy). Colours are sRGB in [0, 1].
namespace applique::draw {

using Outline = std::vector<Vec2>;

struct Rgba {
  double r = 0;
  double g = 0;
  double b = 0;
  double a = 1;
};

Rgba mix(const Rgba& from, const Rgba& to, double t);
Rgba with_alpha(Rgba colour, double alpha);

/// The colour at a pixel.
using Paint = std::function<Rgba(Vec2)>;

Paint solid(const Rgba& colour);

/// Colours at given offsets in [0, 1], mixed linearly between.
struct Stop {
  double offset;
  Rgba colour;
};
Paint linear_gradient(Vec2 from, Vec2 to, std::vector<Stop> stops);
Paint radial_gradient(Vec2 centre, double radius, std::vector<Stop> stops);

/// A point of a brush stroke, and half the stroke's width there.
struct Dab {
  Vec2 point;
  double half_width;
};

class Canvas {
 public:
  Canvas(int width, int height);

  /// Fills closed outlines by the even-odd rule: an outline inside another cuts a hole.
  void fill(std::span<const Outline> outlines, const Paint& paint);
  void fill(const Outline& outline, const Paint& paint) { fill(std::span(&outline, 1), paint); }

  /// Paints round dabs all along a polyline, their width changing linearly between the given ones.
  void stroke(std::span<const Dab> dabs, const Paint& paint);

  /// A line of even width along `line`.
  void line(const Outline& line, double width, const Paint& paint, bool closed = false);

  /// Everything painted until end_clip() lands only inside the outlines (even-odd).
  void begin_clip(std::span<const Outline> outlines);
  void end_clip() { clip_.clear(); }

  /// Makes what lies inside the outlines transparent.
  void erase(std::span<const Outline> outlines);

  /// Straight alpha, 8 bits a channel.
  [[nodiscard]] Image image() const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

 private:
  struct Box {
    int x0, y0, x1, y1;
  };
  [[nodiscard]] std::vector<float> coverage(std::span<const Outline> outlines, Box& box) const;
  /// Calls visit(x, y, share) for the pixels that the outlines cover some of.
  template <class Visit>
  void for_covered(std::span<const Outline> outlines, Visit visit) const;
  void blend(int x, int y, const Rgba& colour, double coverage);

  int width_;
  int height_;
  std::vector<std::array<float, 4>> pixels_;  // premultiplied
  std::vector<float> clip_;
};

/// A cubic Bezier curve as points, its start left out unless asked for.
void append_cubic(Outline& outline, Vec2 a, Vec2 b, Vec2 c);

/// A smooth curve through all points (centripetal Catmull-Rom), open or closed.
Outline spline(std::span<const Vec2> points, bool closed, int steps = 16);

/// The same for a stroke whose width also changes smoothly.
std::vector<Dab> brush(std::span<const Dab> dabs, int steps = 16);

Outline circle(Vec2 centre, double radius);
Outline ring_segment(Vec2 centre, double inner, double outer, double from, double to);
Outline star(Vec2 centre, double outer, double inner, int points, double turn);
Outline rounded_rectangle(Vec2 low, Vec2 high, double radius);

/// x turned over about the vertical line at `axis`.
Outline mirrored(Outline outline, double axis);
std::vector<Dab> mirrored(std::vector<Dab> dabs, double axis);

}  // namespace applique::draw
