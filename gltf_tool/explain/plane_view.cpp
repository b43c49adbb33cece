#include "explain/plane_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "explain/palette.h"

namespace applique {
namespace {

using namespace draw;

constexpr int samples = 3;  // a pixel's side

/// Colours on a grid of `samples` squared samples a pixel, premultiplied.
class SampleGrid {
 public:
  explicit SampleGrid(const Box& box)
      : low_(std::floor(box.low.real()), std::floor(box.low.imag())),
        width_(samples * (static_cast<int>(box.size.real()) + 2)),
        height_(samples * (static_cast<int>(box.size.imag()) + 2)),
        colours_(static_cast<std::size_t>(width_) * height_, Rgba{0, 0, 0, 0}) {}

  /// Calls `colour` with the weights of the corners at each sample in the triangle; either orientation.
  template <class Colour>
  void fill(const std::array<Vec2, 3>& corners, const Colour& colour) {
    std::array<Vec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = static_cast<double>(samples) * (corners[k] - low_) - Vec2(0.5, 0.5);
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    if (area == 0) return;
    const auto [x0, x1] = std::minmax({p[0].real(), p[1].real(), p[2].real()});
    const auto [y0, y1] = std::minmax({p[0].imag(), p[1].imag(), p[2].imag()});
    for (int y = std::max(0, static_cast<int>(std::ceil(y0))); y <= std::min(height_ - 1.0, y1); ++y)
      for (int x = std::max(0, static_cast<int>(std::ceil(x0))); x <= std::min(width_ - 1.0, x1); ++x) {
        const Vec2 at(x, y);
        const double a = cross(p[1] - at, p[2] - at) / area, b = cross(p[2] - at, p[0] - at) / area;
        if (a < 0 || b < 0 || a + b > 1) continue;
        colours_[static_cast<std::size_t>(y) * width_ + x] = colour(a, b, 1 - a - b);
      }
  }

  /// The mean over a pixel.
  [[nodiscard]] Rgba operator()(Vec2 pixel) const {
    const Vec2 p = static_cast<double>(samples) * (pixel - Vec2(0.5, 0.5) - low_);
    const int x0 = static_cast<int>(p.real()), y0 = static_cast<int>(p.imag());
    Rgba sum = {0, 0, 0, 0};
    for (int y = y0; y < y0 + samples; ++y)
      for (int x = x0; x < x0 + samples; ++x) {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
        const Rgba& c = colours_[static_cast<std::size_t>(y) * width_ + x];
        sum.r += c.a * c.r;
        sum.g += c.a * c.g;
        sum.b += c.a * c.b;
        sum.a += c.a;
      }
    if (sum.a <= 0) return {0, 0, 0, 0};
    return {sum.r / sum.a, sum.g / sum.a, sum.b / sum.a, sum.a / (samples * samples)};
  }

 private:
  Vec2 low_;
  int width_, height_;
  std::vector<Rgba> colours_;
};

std::array<Vec2, 3> corners_of(const PatchFace& face, const IdVector<PatchVertexId, Vec2>& at,
                               const PlaneView& view) {
  return {view(at[face.vertices[0]]), view(at[face.vertices[1]]), view(at[face.vertices[2]])};
}

}  // namespace

void draw_patch(Canvas& canvas, const Patch& patch, const IdVector<PatchVertexId, Vec2>& at,
                const PlaneView& view, const FaceColour& colour, double line_width) {
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    const auto corners = corners_of(patch.faces[q], at, view);
    const Outline triangle(corners.begin(), corners.end());
    const Rgba fill = colour(q);
    if (fill.a > 0) canvas.fill(triangle, solid(fill));
  }
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    const auto corners = corners_of(patch.faces[q], at, view);
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchFaceId across = patch.faces[q].neighbours[k];
      if (across.valid() && across < q) continue;  // drawn from there
      canvas.line({corners[(k + 1) % 3], corners[(k + 2) % 3]}, across.valid() ? line_width : 2 * line_width,
                  solid(mix(palette::ink, palette::white, across.valid() ? 0.4 : 0.1)));
    }
  }
}

std::vector<TriangleCorners> triangles_of(const Patch& patch) {
  std::vector<TriangleCorners> triangles;
  for (const auto& [mesh_face, v, neighbours] : patch.faces)
    triangles.push_back({v[0].value, v[1].value, v[2].value});
  return triangles;
}

void paint_triangles(Canvas& canvas, std::span<const Vec2> points, std::span<const TriangleCorners> triangles,
                     const PlaneView& view, const Box& box, const PlaceColour& colour) {
  SampleGrid grid(box);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    grid.fill({view(points[a]), view(points[b]), view(points[c])}, [&](double wa, double wb, double wc) {
      return colour(t, {wa, wb, wc});
    });
  }
  canvas.fill(box.outline(), [&](Vec2 pixel) { return grid(pixel); });
}

}  // namespace applique
