#include "applique/region/outline.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "applique/region/alpha_mask.h"
#include "applique/region/edge_grid.h"

namespace applique {
namespace {

constexpr double outline_tolerance =
    0.75;  // Pixels: just over the half diagonal that a slanted staircase needs.
// How far off a shared corner the curve passes: less than half, so that it stays in its pixel.
constexpr double corner_offset = 0.25;
// A chord over more vertices than this gains nothing and would cost a long look back.
constexpr std::size_t longest_chain = 4096;

/// Clockwise on the screen around the one island of `mask`, from its first pixel's top-left corner.
std::vector<Pixel> trace_mask(const AlphaMask& mask) {
  const auto first = std::find(mask.bits.begin(), mask.bits.end(), std::uint8_t{1}) - mask.bits.begin();
  const int start_x = static_cast<int>(first % mask.width), start_y = static_cast<int>(first / mask.width);
  std::vector<Pixel> curve;
  int x = start_x, y = start_y;  // A corner: the top-left one of pixel (x, y).
  int dx = 0, dy = -1;           // Arriving there along the pixel's left side, island to the right.
  do {
    // The pixels that meet at the corner, ahead to the left and to the right of the way; (dy, -dx) is left.
    const int ahead_x = x + (dx + dy - 1) / 2, ahead_y = y + (dy - dx - 1) / 2;
    const bool left = mask.has(ahead_x, ahead_y);
    const bool right = mask.has(ahead_x - dy, ahead_y + dx);
    if (left || !right) {
      const double offset = left && !right ? corner_offset : 0;  // Two pixels that share only this corner.
      curve.push_back({x - 1 + offset * (dy - dx), y - 1 + offset * (-dx - dy)});
      const int turned_dx = left ? dy : -dy, turned_dy = left ? -dx : dx;
      dx = turned_dx;
      dy = turned_dy;
    }
    x += dx;
    y += dy;
  } while (x != start_x || y != start_y || dx != 0 || dy != -1);
  return curve;
}

double cross(Pixel a, Pixel b) {
  return a.x * b.y - a.y * b.x;
}
double dot(Pixel a, Pixel b) {
  return a.x * b.x + a.y * b.y;
}
Pixel minus(Pixel a, Pixel b) {
  return {a.x - b.x, a.y - b.y};
}

/// Chords over stretches of a closed curve with its inside to the right on the screen (positive cross
/// products).
class Chords {
 public:
  Chords(const std::vector<Pixel>& curve, double tolerance)
      : curve_(curve), tolerance_(tolerance), kept_(curve.size(), 0) {}

  /// The vertices where chords end: from `from` on, each as far as it may.
  [[nodiscard]] std::vector<std::size_t> walk() const {
    std::vector<std::size_t> ends;
    for (std::size_t i = 0; i < curve_.size(); i = farthest(i)) ends.push_back(i);
    return ends;
  }

  /// From now on the chord from i to j is no more: its stretch gets shorter ones.
  void split(std::size_t i, std::size_t j) { kept_[i] = kept_[(i + j) / 2] = kept_[j % curve_.size()] = 1; }

 private:
  [[nodiscard]] Pixel at(std::size_t i) const { return curve_[i < curve_.size() ? i : 0]; }

  // The directions in which a chord from i leaves nothing outside (beyond `inner_limit`) and nothing too far
  // inside (beyond `outer_limit`) form a wedge that only shrinks.
  [[nodiscard]] std::size_t farthest(std::size_t i) const {
    const Pixel origin = at(i);
    std::vector<std::size_t> candidates = {i + 1};
    Pixel inner_limit, outer_limit;
    bool has_inner = false, has_outer = false;
    const std::size_t end = std::min(curve_.size(), i + longest_chain);
    for (std::size_t j = i + 1; j < end && !kept_[j]; ++j) {
      const Pixel v = minus(at(j), origin);  // Left out by everything further.
      if (!has_inner || cross(inner_limit, v) < 0) inner_limit = v;
      has_inner = true;
      const double length = std::hypot(v.x, v.y);
      if (length > tolerance_) {
        const double sine = tolerance_ / length, cosine = std::sqrt(1 - sine * sine);
        const Pixel bound = {v.x * cosine + v.y * sine, v.y * cosine - v.x * sine};
        if (!has_outer || cross(outer_limit, bound) > 0) outer_limit = bound;
        has_outer = true;
        if (cross(outer_limit, inner_limit) < 0) break;
      }
      const Pixel d = minus(at(j + 1), origin);
      if (cross(d, inner_limit) >= 0 && (!has_outer || cross(outer_limit, d) >= 0))
        candidates.push_back(j + 1);
    }
    while (!may_replace(i, candidates.back())) candidates.pop_back();
    return candidates.back();
  }

  /// Whether all between i and j lies inside of the chord and no further from it than the tolerance.
  [[nodiscard]] bool may_replace(std::size_t i, std::size_t j) const {
    const Pixel d = minus(at(j), at(i));
    const double length = dot(d, d);
    for (std::size_t k = i + 1; k < j; ++k) {
      const Pixel v = minus(at(k), at(i));
      if (cross(d, v) < 0) return false;
      const double t = length > 0 ? std::clamp(dot(v, d) / length, 0.0, 1.0) : 0;
      if (std::hypot(v.x - t * d.x, v.y - t * d.y) > tolerance_) return false;
    }
    return true;
  }

  const std::vector<Pixel>& curve_;
  double tolerance_;
  std::vector<char> kept_;
};

}  // namespace

std::vector<Pixel> rectangle_outline(const Image& image) {
  const double width = image.width, height = image.height;
  return {{0, 0}, {width, 0}, {width, height}, {0, height}};
}

Result<std::vector<Pixel>> trace_alpha(const Image& image, double threshold) {
  AlphaMask mask = make_alpha_mask(image, threshold);
  if (std::find(mask.bits.begin(), mask.bits.end(), std::uint8_t{1}) == mask.bits.end()) {
    return fail(
        ErrorCode::region_empty,
        fmt::format("no pixel's alpha is over {:g}; lower the region's \"alpha\", or give it a \"contour\" "
                    "if the image is transparent all over",
                    threshold));
  }
  fill_holes(mask);
  bridge_islands(mask);
  return trace_mask(mask);
}

// Chords bulge outwards and may run into each other in narrow gaps: those are split until none do. Ends,
// because the traced curve itself is simple.
std::vector<Pixel> simplify_outline(const std::vector<Pixel>& traced, double tolerance) {
  Chords chords(traced, tolerance);
  while (true) {
    const std::vector<std::size_t> ends = chords.walk();
    std::vector<Pixel> outline;
    std::vector<Vec2> polygon;
    for (const std::size_t i : ends) {
      outline.push_back(traced[i]);
      polygon.emplace_back(traced[i].x, traced[i].y);
    }
    bool simple = true;
    const auto split = [&](std::uint32_t edge) {
      const std::size_t next = edge + 1 < ends.size() ? ends[edge + 1] : traced.size();
      if (next == ends[edge] + 1) return false;
      chords.split(ends[edge], next);
      return true;
    };
    const auto resolve = [&](std::uint32_t e, std::uint32_t f) {
      if (!improper_meeting(polygon, e, f)) return;
      simple = false;
      const bool split_e = split(e), split_f = split(f);
      APPLIQUE_ASSERT(split_e || split_f);  // Two edges of the traced curve do not meet.
    };
    if (polygon.size() < 3) {  // A thin sliver whose chords fall on each other.
      simple = false;
      for (std::uint32_t edge = 0; edge < polygon.size(); ++edge) split(edge);
    } else {
      EdgeGrid(polygon).visit_pairs(resolve);
    }
    if (simple) return outline;
  }
}

Result<std::vector<Pixel>> alpha_outline(const Image& image, double threshold) {
  APPLIQUE_TRY(const std::vector<Pixel> traced, trace_alpha(image, threshold));
  return simplify_outline(traced, outline_tolerance);
}

}  // namespace applique
