#include "applique/rivals/stroke_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "applique/decal_input.h"
#include "applique/rivals/geodesic_front.h"
#include "applique/rivals/stroke_axis.h"
#include "applique/surface/surface_line.h"

namespace applique {
namespace {

constexpr double axis_tolerance = 0.05;  // of the region's diameter
constexpr double off_edges = 1e-6;       // least weight of a corner: curves neither start nor end on vertices

SurfacePoint inside_face(SurfacePoint point) {
  double sum = 0;
  for (double& weight : point.barycentric) sum += weight = std::max(weight, off_edges);
  for (double& weight : point.barycentric) weight /= sum;
  return point;
}

/// The axis as a curve on the surface.
struct Stroke {
  SurfaceLine line;
  double start = 0;          ///< The arc length, from the anchor, of the curve's first point.
  std::vector<double> arcs;  ///< Those of the axis' features, increasing; 0 at the anchor.
  double scale = 1;          ///< Mean, plane units per scene unit.
};

Vec3 last_piece(const SurfaceLine& line) {
  return line.points.back() - line.points[line.points.size() - 2];
}

/// What the region has of the axis: how far it goes, plane units from the origin.
std::pair<double, double> extent_along(const StrokeAxis& axis, const Region& region) {
  double low = 0, high = 0;
  for (const Vec2 z : region.polygon()) {
    low = std::min(low, axis.along(z));
    high = std::max(high, axis.along(z));
  }
  return {low, high};
}

/// Draws the axis on the surface.
class StrokeDrawing {
 public:
  StrokeDrawing(const SurfaceMesh& surface, const RivalTask& task, const StrokeAxis& axis)
      : surface_(surface), task_(task), axis_(axis) {}

  Result<Stroke> draw() {
    APPLIQUE_CHECK(join_features());
    extend();
    return std::move(stroke_);
  }

 private:
  [[nodiscard]] SurfacePoint place(std::size_t feature) const {
    return inside_face(task_.input.features[feature].surface);
  }

  /// The legs from feature to feature.
  Result<void> join_features() {
    stroke_.arcs = {0};
    for (std::size_t i = 1; i < axis_.features.size(); ++i) {
      const SurfaceLine leg =
          geodesic_between(surface_, place(axis_.features[i - 1]), place(axis_.features[i]));
      const double length = leg.length();
      if (!(length > 0))
        return fail(ErrorCode::not_solved,
                    fmt::format("decal '{}': no stroke leads on the surface from {} to {}; place them apart, "
                                "on one connected part",
                                task_.input.name, feature_name(task_.input, axis_.features[i - 1]),
                                feature_name(task_.input, axis_.features[i])));
      stroke_.line.append(leg);
      stroke_.arcs.push_back(stroke_.arcs.back() + length);
    }
    const auto anchor = std::find(axis_.features.begin(), axis_.features.end(), task_.anchor);
    const double at_anchor = stroke_.arcs[static_cast<std::size_t>(anchor - axis_.features.begin())];
    for (double& arc : stroke_.arcs) arc -= at_anchor;
    stroke_.scale = stroke_.arcs.size() > 1 ? (axis_.places.back() - axis_.places.front()) /
                                                  (stroke_.arcs.back() - stroke_.arcs.front())
                                            : lone_scale(task_.input);
    return {};
  }

  /// Straight on over the rest of the region, both ways.
  void extend() {
    const auto [low, high] = extent_along(axis_, task_.input.region);
    const SurfaceLine& legs = stroke_.line;
    const bool lone = legs.faces.empty();
    const Vec3 forth = lone ? task_.frame.x : last_piece(legs);
    const Vec3 back = lone ? Vec3(-task_.frame.x) : last_piece(legs.reversed());
    const SurfaceLine after = geodesic_from(surface_, place(axis_.features.back()), forth,
                                            (high - axis_.places.back()) / stroke_.scale);
    SurfaceLine whole = geodesic_from(surface_, place(axis_.features.front()), back,
                                      (axis_.places.front() - low) / stroke_.scale)
                            .reversed();
    stroke_.start = stroke_.arcs.front() - whole.length();
    whole.append(legs);
    whole.append(after);
    stroke_.line = std::move(whole);
  }

  const SurfaceMesh& surface_;
  const RivalTask& task_;
  const StrokeAxis& axis_;
  Stroke stroke_;
};

/// Gives the corners of the faces under the curve their coordinates: arc length and signed distance.
void start_at(const SurfaceMesh& surface, const Stroke& stroke, GeodesicFront& front) {
  double arc = stroke.start;
  for (std::size_t i = 0; i < stroke.line.faces.size(); ++i) {
    const Vec3& from = stroke.line.points[i];
    const Vec3 piece = stroke.line.points[i + 1] - from;
    const double length = piece.norm();
    if (!(length > 0)) continue;
    const Vec3 normal = face_normal(surface, stroke.line.faces[i]), along = piece / length;
    const TangentFrame frame = {from, along, normal.cross(along), normal};
    for (VertexId v : surface.faces[stroke.line.faces[i]]) {
      const Vec2 at = frame.coordinates(surface.positions[v]);
      const double distance = std::abs(at - std::clamp(at.real(), 0.0, length));
      front.start(v, distance, arc + at, along, normal);
    }
    arc += length;
  }
}

/// Where the image has what is so far along the curve and so far beside it, scene units.
Vec2 image_of(const StrokeAxis& axis, const Stroke& stroke, Vec2 at) {
  const auto& arcs = stroke.arcs;
  const double arc = std::clamp(at.real(), arcs.front(), arcs.back());
  std::size_t next = 0;
  while (arcs[next] < arc) ++next;
  double along = axis.places[next];
  if (next > 0) along -= (arcs[next] - arc) / (arcs[next] - arcs[next - 1]) * (along - axis.places[next - 1]);
  return axis.origin +
         axis.direction * Vec2(along + stroke.scale * (at.real() - arc), stroke.scale * at.imag());
}

}  // namespace

Result<RivalMap> map_along_stroke(const SurfaceMesh& surface, const RivalTask& task) {
  const auto& features = task.input.features;
  const StrokeAxis axis =
      find_stroke_axis(task.targets, task.anchor, axis_tolerance * task.input.region.diameter());
  APPLIQUE_TRY(const Stroke stroke, StrokeDrawing(surface, task, axis).draw());
  GeodesicFront front(surface, Parents::upwind);
  start_at(surface, stroke, front);
  front.reach(features);

  Vec2 shift = 0;
  const auto to_image = [&](Vec2 at) { return image_of(axis, stroke, at) + shift; };
  shift = task.targets[task.anchor] - front.image_of(features[task.anchor].surface, to_image);
  RivalMap map = front.cover(RegionBox(task.input.region), to_image);
  for (const Feature& feature : features) map.features.push_back(front.image_of(feature.surface, to_image));
  map.lines = {stroke.line.points};
  return map;
}

}  // namespace applique
