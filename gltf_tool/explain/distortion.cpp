#include "explain/distortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "applique/base/predicates.h"
#include "applique/image/coverage.h"

#include "explain/digits.h"
#include "explain/image_view.h"
#include "explain/palette.h"
#include "explain/plane_view.h"

namespace applique {
namespace {

using namespace draw;

constexpr double longer_side = 1536;   // of a painting, pixels
constexpr double within_limit = 0.98;  // of the area, which the colours tell apart
constexpr std::array<double, 7> limits = {1.1, 1.25, 1.5, 2, 3, 5, 10};

/// What is known of a face.
struct FaceDistortion {
  bool shown;    ///< It shows some of the region.
  bool flipped;  ///< In the image.
  double value;  ///< Of the distortion.
  double area;   ///< In the image, plane units squared.
};

std::array<Vec2, 3> image_of(const DecalMap& map, PatchFaceId q) {
  const auto& v = map.patch.faces[q].vertices;
  return {map.image[v[0]], map.image[v[1]], map.image[v[2]]};
}

IdVector<PatchFaceId, FaceDistortion> measure_faces(const SolvedDecal& decal, Distortion kind) {
  const DecalMap& map = decal.map;
  IdVector<PatchFaceId, FaceDistortion> faces(map.patch.faces.size(), {false, false, 1, 0});
  double surface_area = 0, image_area = 0;
  for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    if (map.textured[q] == 0 || !map.patch.faces[q].mesh_face.valid()) continue;
    const auto p = image_of(map, q);
    FaceDistortion& face = faces[q];
    face.shown = true;
    face.flipped = orientation(p[0], p[1], p[2]) <= 0;
    if (face.flipped) continue;
    face.area = 0.5 * cross(p[1] - p[0], p[2] - p[0]);
    const auto [larger, smaller] =
        singular_values(decal.surface->mesh.corners(map.patch.faces[q].mesh_face), p);
    face.value = kind == Distortion::area ? larger * smaller : larger / smaller;
    surface_area += larger * smaller * face.area;
    image_area += face.area;
  }
  if (kind == Distortion::area)
    for (FaceDistortion& face : faces) face.value *= image_area / surface_area;
  return faces;
}

/// The least round number that most of the area keeps within.
double find_limit(const IdVector<PatchFaceId, FaceDistortion>& faces) {
  const auto area_within = [&](double limit) {
    double area = 0;
    for (const FaceDistortion& face : faces)
      if (std::abs(std::log(face.value)) <= std::log(limit)) area += face.area;
    return area;
  };
  const double whole = area_within(std::numeric_limits<double>::infinity());
  for (const double limit : limits)
    if (area_within(limit) >= within_limit * whole) return limit;
  return limits.back();
}

Rgba colour_of(double value, Distortion kind, double limit) {
  const double share = std::log(value) / std::log(limit);
  if (kind == Distortion::angle) return ramp_colour(palette::rising, share);
  return ramp_colour(palette::diverging, 0.5 + 0.5 * share);
}

}  // namespace

DistortionPicture paint_distortion(const SolvedDecal& decal, Distortion kind) {
  const ImageFrame& frame = decal.region.frame();
  const double scale = longer_side / std::max(frame.width, frame.height);
  const auto faces = measure_faces(decal, kind);
  DistortionPicture picture = {kind, find_limit(faces), {}};

  Canvas canvas(static_cast<int>(std::ceil(scale * frame.width)),
                static_cast<int>(std::ceil(scale * frame.height)));
  const Box whole = {{0, 0}, {static_cast<double>(canvas.width()), static_cast<double>(canvas.height())}};
  canvas.fill(whole.outline(), solid(palette::pale));
  // Pixels of the image, turned over so that the view turns them back.
  std::vector<Vec2> points;
  for (const Vec2 z : decal.map.image) {
    const Pixel at = frame.to_pixel(z);
    points.emplace_back(at.x, -at.y);
  }
  const std::vector<TriangleCorners> all = triangles_of(decal.map.patch);
  std::vector<TriangleCorners> triangles;
  std::vector<Rgba> colours;
  for (const bool flipped : {false, true})  // Those on top.
    for (PatchFaceId q : ids<PatchFaceId>(faces.size())) {
      if (!faces[q].shown || faces[q].flipped != flipped) continue;
      triangles.push_back(all[q.value]);
      colours.push_back(flipped ? palette::flipped : colour_of(faces[q].value, kind, picture.limit));
    }
  paint_triangles(canvas, points, triangles, {0, 0, scale}, whole,
                  [&](std::size_t t, const std::array<double, 3>&) { return colours[t]; });

  picture.painting = canvas.image();
  std::vector<Pixel> contour = decal.region.contour();
  for (Pixel& corner : contour) corner = {scale * corner.x, scale * corner.y};
  const std::vector<float> inside = polygon_coverage(contour, canvas.width(), 0, canvas.height());
  for (std::size_t i = 0; i < inside.size(); ++i)
    picture.painting.rgba[4 * i + 3] = static_cast<std::uint16_t>(std::lround(0xffff * inside[i]));
  return picture;
}

void draw_distortion(Canvas& canvas, const SolvedDecal& decal, const DistortionPicture& picture,
                     const Box& box) {
  const PlaneView view = view_of_image(decal, box);
  const ImageFrame& frame = decal.region.frame();
  const double scale = picture.painting.width / frame.width;
  const double footprint = scale * frame.pixels_per_unit() / view.scale;
  canvas.fill(view(decal.region.polygon()), [&](Vec2 p) {
    const Pixel at = frame.to_pixel(view.to_plane(p));
    return sample_image(picture.painting, {scale * at.x, scale * at.y}, footprint);
  });
  draw_contour(canvas, decal.region.polygon(), view, pen_for(box).thin);
  draw_features(canvas, targets_of(decal), view, pen_for(box));
}

void draw_legend(Canvas& canvas, const DistortionPicture& picture, const Box& box) {
  const double least = picture.kind == Distortion::area ? 1 / picture.limit : 1;
  const double digits = std::min(0.045 * box.size.imag(), 0.16 * box.size.real());
  const Vec2 low = box.low + Vec2(0, digits);
  const Vec2 size(0.25 * box.size.real(), box.size.imag() - 2 * digits);
  const auto height_of = [&](double value) {
    return low.imag() + size.imag() * std::log(picture.limit / value) / std::log(picture.limit / least);
  };
  const Box bar = {low, size};
  canvas.fill(bar.outline(), [&](Vec2 p) {
    const double share = 1 - (p.imag() - low.imag()) / size.imag();
    return colour_of(least * std::pow(picture.limit / least, share), picture.kind, picture.limit);
  });
  std::vector<double> marks = {picture.limit, std::sqrt(picture.limit), 1};
  if (picture.kind == Distortion::area) marks.insert(marks.end(), {std::sqrt(least), least});
  for (const double mark : marks) {
    const double y = height_of(mark), right = low.real() + size.real();
    canvas.line({{right, y}, {right + 0.4 * digits, y}}, pen_for(box).thin, solid(palette::ink));
    draw_decimal(canvas, mark, {right + 0.8 * digits, y}, digits, solid(palette::ink));
  }
}

}  // namespace applique
