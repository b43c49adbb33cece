#include "applique/image/draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace applique::draw {
namespace {

constexpr int sub_lines = 8;  // scan lines a pixel

double distance_to_segment(Vec2 p, Vec2 a, Vec2 b, double& t) {
  const Vec2 ab = b - a;
  const double length2 = std::norm(ab);
  t = length2 > 0 ? std::clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0;
  return std::abs(p - a - t * ab);
}

Paint gradient(std::vector<Stop> stops, std::function<double(Vec2)> offset) {
  return [stops = std::move(stops), offset = std::move(offset)](Vec2 p) {
    const double t = offset(p);
    if (t <= stops.front().offset) return stops.front().colour;
    for (std::size_t i = 1; i < stops.size(); ++i)
      if (t <= stops[i].offset)
        return mix(stops[i - 1].colour, stops[i].colour,
                   (t - stops[i - 1].offset) / (stops[i].offset - stops[i - 1].offset));
    return stops.back().colour;
  };
}

}  // namespace

Rgba mix(const Rgba& from, const Rgba& to, double t) {
  return {from.r + t * (to.r - from.r), from.g + t * (to.g - from.g), from.b + t * (to.b - from.b),
          from.a + t * (to.a - from.a)};
}

Rgba with_alpha(Rgba colour, double alpha) {
  colour.a = alpha;
  return colour;
}

Paint solid(const Rgba& colour) {
  return [colour](Vec2) { return colour; };
}

Paint linear_gradient(Vec2 from, Vec2 to, std::vector<Stop> stops) {
  const Vec2 axis = to - from;
  return gradient(std::move(stops), [from, axis](Vec2 p) { return dot(p - from, axis) / std::norm(axis); });
}

Paint radial_gradient(Vec2 centre, double radius, std::vector<Stop> stops) {
  return gradient(std::move(stops), [centre, radius](Vec2 p) { return std::abs(p - centre) / radius; });
}

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height) {}

void Canvas::blend(int x, int y, const Rgba& colour, double coverage) {
  const std::size_t i = static_cast<std::size_t>(y) * width_ + x;
  if (!clip_.empty()) coverage *= clip_[i];
  const double alpha = colour.a * coverage;
  const double channels[4] = {colour.r * alpha, colour.g * alpha, colour.b * alpha, alpha};
  for (int c = 0; c < 4; ++c) pixels_[i][c] = static_cast<float>(channels[c] + pixels_[i][c] * (1 - alpha));
}

std::vector<float> Canvas::coverage(std::span<const Outline> outlines, Box& box) const {
  double low_x = 1e9;
  double low_y = 1e9;
  double high_x = -1e9;
  double high_y = -1e9;
  for (const Outline& outline : outlines)
    for (const Vec2 p : outline) {
      low_x = std::min(low_x, p.real());
      high_x = std::max(high_x, p.real());
      low_y = std::min(low_y, p.imag());
      high_y = std::max(high_y, p.imag());
    }
  box = {std::max(0, static_cast<int>(std::floor(low_x))), std::max(0, static_cast<int>(std::floor(low_y))),
         std::min(width_, static_cast<int>(std::ceil(high_x)) + 1),
         std::min(height_, static_cast<int>(std::ceil(high_y)) + 1)};
  if (box.x1 <= box.x0 || box.y1 <= box.y0) return {};
  const int w = box.x1 - box.x0;
  std::vector<float> cover(static_cast<std::size_t>(w) * (box.y1 - box.y0), 0.0F);
  std::vector<double> crossings;
  for (int y = box.y0; y < box.y1; ++y)
    for (int sub = 0; sub < sub_lines; ++sub) {
      const double line = y + (sub + 0.5) / sub_lines;
      crossings.clear();
      for (const Outline& outline : outlines)
        for (std::size_t i = 0; i < outline.size(); ++i) {
          const Vec2 a = outline[i];
          const Vec2 b = outline[(i + 1) % outline.size()];
          if ((a.imag() <= line) == (b.imag() <= line)) continue;
          crossings.push_back(a.real() + (line - a.imag()) / (b.imag() - a.imag()) * (b.real() - a.real()));
        }
      std::sort(crossings.begin(), crossings.end());
      float* row = &cover[static_cast<std::size_t>(y - box.y0) * w];
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const double from = std::clamp(crossings[i] - box.x0, 0.0, static_cast<double>(w));
        const double to = std::clamp(crossings[i + 1] - box.x0, 0.0, static_cast<double>(w));
        for (int x = static_cast<int>(from); x < to && x < w; ++x)
          row[x] += static_cast<float>((std::min(to, x + 1.0) - std::max(from, static_cast<double>(x))) /
                                       sub_lines);
      }
    }
  return cover;
}

template <class Visit>
void Canvas::for_covered(std::span<const Outline> outlines, Visit visit) const {
  Box box{};
  const std::vector<float> cover = coverage(outlines, box);
  if (cover.empty()) return;
  const float* at = cover.data();
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x, ++at)
      if (*at > 0) visit(x, y, *at);
}

void Canvas::fill(std::span<const Outline> outlines, const Paint& paint) {
  for_covered(outlines,
              [&](int x, int y, float cover) { blend(x, y, paint(Vec2(x + 0.5, y + 0.5)), cover); });
}

void Canvas::stroke(std::span<const Dab> dabs, const Paint& paint) {
  double low_x = 1e9;
  double low_y = 1e9;
  double high_x = -1e9;
  double high_y = -1e9;
  for (const Dab& dab : dabs) {
    low_x = std::min(low_x, dab.point.real() - dab.half_width);
    high_x = std::max(high_x, dab.point.real() + dab.half_width);
    low_y = std::min(low_y, dab.point.imag() - dab.half_width);
    high_y = std::max(high_y, dab.point.imag() + dab.half_width);
  }
  const int x0 = std::max(0, static_cast<int>(low_x) - 1);
  const int y0 = std::max(0, static_cast<int>(low_y) - 1);
  const int x1 = std::min(width_, static_cast<int>(high_x) + 2);
  const int y1 = std::min(height_, static_cast<int>(high_y) + 2);
  if (x1 <= x0 || y1 <= y0) return;
  const int w = x1 - x0;
  std::vector<float> inside(static_cast<std::size_t>(w) * (y1 - y0), -1e9F);
  for (std::size_t i = 0; i + 1 < dabs.size(); ++i) {
    const Dab& a = dabs[i];
    const Dab& b = dabs[i + 1];
    const double reach = std::max(a.half_width, b.half_width) + 1;
    const int from_y = std::max(y0, static_cast<int>(std::min(a.point.imag(), b.point.imag()) - reach));
    const int to_y = std::min(y1, static_cast<int>(std::max(a.point.imag(), b.point.imag()) + reach) + 1);
    const int from_x = std::max(x0, static_cast<int>(std::min(a.point.real(), b.point.real()) - reach));
    const int to_x = std::min(x1, static_cast<int>(std::max(a.point.real(), b.point.real()) + reach) + 1);
    for (int y = from_y; y < to_y; ++y)
      for (int x = from_x; x < to_x; ++x) {
        double t = 0;
        const double distance = distance_to_segment(Vec2(x + 0.5, y + 0.5), a.point, b.point, t);
        float& best = inside[static_cast<std::size_t>(y - y0) * w + x - x0];
        best =
            std::max(best, static_cast<float>(a.half_width + t * (b.half_width - a.half_width) - distance));
      }
  }
  const float* at = inside.data();
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x, ++at) {
      const double cover = std::clamp(*at + 0.5, 0.0, 1.0);
      if (cover > 0) blend(x, y, paint(Vec2(x + 0.5, y + 0.5)), cover);
    }
}

void Canvas::line(const Outline& line, double width, const Paint& paint, bool closed) {
  std::vector<Dab> dabs;
  for (const Vec2 p : line) dabs.push_back({p, 0.5 * width});
  if (closed) dabs.push_back(dabs.front());
  stroke(dabs, paint);
}

void Canvas::begin_clip(std::span<const Outline> outlines) {
  clip_.assign(pixels_.size(), 0.0F);
  for_covered(outlines, [&](int x, int y, float cover) {
    clip_[static_cast<std::size_t>(y) * width_ + x] = std::min(cover, 1.0F);
  });
}

void Canvas::erase(std::span<const Outline> outlines) {
  for_covered(outlines, [&](int x, int y, float cover) {
    for (float& channel : pixels_[static_cast<std::size_t>(y) * width_ + x])
      channel *= 1 - std::min(cover, 1.0F);
  });
}

Image Canvas::image() const {
  Image out;
  out.width = width_;
  out.height = height_;
  out.rgba.resize(4 * pixels_.size());
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const auto& p = pixels_[i];
    for (int c = 0; c < 3; ++c) {
      const double straight = p[3] > 0 ? std::clamp(p[c] / p[3], 0.0F, 1.0F) : 0;
      out.rgba[4 * i + c] = static_cast<std::uint16_t>(257 * std::lround(255 * straight));
    }
    out.rgba[4 * i + 3] = static_cast<std::uint16_t>(257 * std::lround(255 * std::clamp(p[3], 0.0F, 1.0F)));
  }
  return out;
}

void append_cubic(Outline& outline, Vec2 a, Vec2 b, Vec2 c) {
  const Vec2 start = outline.back();
  constexpr int steps = 24;
  for (int i = 1; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double s = 1 - t;
    outline.push_back(s * s * s * start + 3 * s * s * t * a + 3 * s * t * t * b + t * t * t * c);
  }
}

Outline spline(std::span<const Vec2> points, bool closed, int steps) {
  Outline out;
  const auto n = static_cast<int>(points.size());
  const auto at = [&](int i) { return closed ? points[(i + n) % n] : points[std::clamp(i, 0, n - 1)]; };
  for (int i = 0; i < (closed ? n : n - 1); ++i) {
    const Vec2 p0 = at(i - 1);
    const Vec2 p1 = at(i);
    const Vec2 p2 = at(i + 1);
    const Vec2 p3 = at(i + 2);
    const double d01 = std::max(std::sqrt(std::abs(p1 - p0)), 1e-6);
    const double d12 = std::max(std::sqrt(std::abs(p2 - p1)), 1e-6);
    const double d23 = std::max(std::sqrt(std::abs(p3 - p2)), 1e-6);
    Vec2 m1 = (p2 - p1) + d12 * ((p1 - p0) / d01 - (p2 - p0) / (d01 + d12));
    Vec2 m2 = (p2 - p1) + d12 * ((p3 - p2) / d23 - (p3 - p1) / (d12 + d23));
    if (!closed && i == 0) m1 = p2 - p1;
    if (!closed && i == n - 2) m2 = p2 - p1;
    for (int s = 0; s < steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      const double t2 = t * t;
      const double t3 = t2 * t;
      out.push_back((2 * t3 - 3 * t2 + 1) * p1 + (t3 - 2 * t2 + t) * m1 + (3 * t2 - 2 * t3) * p2 +
                    (t3 - t2) * m2);
    }
  }
  if (!closed) out.push_back(points.back());
  return out;
}

std::vector<Dab> brush(std::span<const Dab> dabs, int steps) {
  std::vector<Vec2> points;
  for (const Dab& dab : dabs) points.push_back(dab.point);
  const Outline curve = spline(points, false, steps);
  std::vector<Dab> out;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const std::size_t segment = std::min(i / steps, dabs.size() - 2);
    const double t = static_cast<double>(i - segment * steps) / steps;
    const double eased = t * t * (3 - 2 * t);
    out.push_back({curve[i], dabs[segment].half_width +
                                 eased * (dabs[segment + 1].half_width - dabs[segment].half_width)});
  }
  return out;
}

Outline circle(Vec2 centre, double radius) {
  Outline out;
  constexpr int n = 96;
  for (int i = 0; i < n; ++i) out.push_back(centre + std::polar(radius, 2 * std::numbers::pi * i / n));
  return out;
}

Outline ring_segment(Vec2 centre, double inner, double outer, double from, double to) {
  Outline out;
  constexpr int n = 48;
  for (int i = 0; i <= n; ++i) out.push_back(centre + std::polar(outer, from + (to - from) * i / n));
  for (int i = n; i >= 0; --i) out.push_back(centre + std::polar(inner, from + (to - from) * i / n));
  return out;
}

Outline star(Vec2 centre, double outer, double inner, int points, double turn) {
  Outline out;
  for (int i = 0; i < 2 * points; ++i)
    out.push_back(centre + std::polar(i % 2 == 0 ? outer : inner, turn + std::numbers::pi * i / points));
  return out;
}

Outline rounded_rectangle(Vec2 low, Vec2 high, double radius) {
  Outline out;
  const Vec2 corners[4] = {{high.real() - radius, high.imag() - radius},
                           {low.real() + radius, high.imag() - radius},
                           {low.real() + radius, low.imag() + radius},
                           {high.real() - radius, low.imag() + radius}};
  for (int corner = 0; corner < 4; ++corner)
    for (int i = 0; i <= 16; ++i)
      out.push_back(corners[corner] + std::polar(radius, (corner + i / 16.0) * std::numbers::pi / 2));
  return out;
}

Outline mirrored(Outline outline, double axis) {
  for (Vec2& p : outline) p = {2 * axis - p.real(), p.imag()};
  return outline;
}

std::vector<Dab> mirrored(std::vector<Dab> dabs, double axis) {
  for (Dab& dab : dabs) dab.point = {2 * axis - dab.point.real(), dab.point.imag()};
  return dabs;
}

}  // namespace applique::draw
