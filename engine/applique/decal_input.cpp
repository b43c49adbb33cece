#include "applique/decal_input.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace applique {
namespace {

constexpr double on_contour = 1e-9;      // plane units
constexpr double coincident = 1e-6;      // of the region's diameter
constexpr double least_coverage = 0.01;  // below it the result is of no use

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

}  // namespace

std::string feature_name(const DecalInput& input, std::size_t k) {
  return fmt::format("feature {} at ({:.1f}, {:.1f})", k, input.features[k].image.x,
                     input.features[k].image.y);
}

bool checks_patch(const SolveOptions& options) {
#ifdef APPLIQUE_CHECK_INVARIANTS
  static_cast<void>(options);
  return true;
#else
  return options.check_patch;
#endif
}

std::vector<Vec2> targets_of(const DecalInput& input) {
  std::vector<Vec2> targets;
  for (const Feature& feature : input.features)
    targets.push_back(input.region.frame().to_plane(feature.image));
  return targets;
}

std::string weld_note(const SurfaceMesh& surface) {
  std::string note;
  if (surface.cut_edges > 0)
    note += fmt::format(
        "; edges that more than two triangles share, or two that face opposite sides, are cut "
        "open: {} of them",
        surface.cut_edges);
  if (surface.dropped_triangles > 0)
    note += fmt::format("; triangles whose corners are too near to tell apart are left out: {} of them",
                        surface.dropped_triangles);
  return note;
}

tl::unexpected<Error> fail_mirrored(const SurfaceMesh& surface, const DecalInput& input) {
  return fail(
      ErrorCode::features_mirrored,
      fmt::format("decal '{}': the features 0 to {} run one way round in the image and the other way "
                  "round on the surface, so that the image would have to be mirrored; swap the "
                  "places of left and right, or {} \"mirrored\": true{}",
                  input.name, input.features.size() - 1,
                  input.region.frame().mirrored ? "leave out" : "give the decal", weld_note(surface)));
}

Result<void> check_input(const SurfaceMesh& surface, const DecalInput& input,
                         const std::vector<Vec2>& targets, Overlap overlap) {
  const std::string prefix = fmt::format("decal '{}': ", input.name);
  if (input.features.empty())
    return fail(ErrorCode::feature_place_invalid,
                prefix + "has no features; pin at least one point of the image");
  const double pixels = input.region.frame().pixels_per_unit();
  for (std::size_t k = 0; k < input.features.size(); ++k) {
    // A feature on a slanted edge of the contour may lie outside by rounding.
    if (!input.region.contains(targets[k]) && input.region.signed_distance(targets[k]) < -on_contour)
      return fail(
          ErrorCode::feature_outside_region,
          fmt::format("{}{}: outside the contour by {:.1f} px; move it inside or widen the region", prefix,
                      feature_name(input, k), -input.region.signed_distance(targets[k]) * pixels));
    for (std::size_t j = 0; j < k; ++j) {
      if (std::abs(targets[k] - targets[j]) < coincident * input.region.diameter())
        return fail(ErrorCode::features_coincide,
                    fmt::format("{}{} and {} are on one spot of the image; remove one of them", prefix,
                                feature_name(input, j), feature_name(input, k)));
      const Vec3 a = position_of(surface, input.features[j].surface),
                 b = position_of(surface, input.features[k].surface);
      const auto corners = surface.corners(input.features[k].surface.face);
      const double size = (corners[1] - corners[0]).norm() + (corners[2] - corners[0]).norm();
      if (overlap == Overlap::stop && (a - b).norm() <= coincident * size)
        return fail(ErrorCode::features_coincide,
                    fmt::format("{}{} and {} are on one spot of the surface, or all but; remove one of them, "
                                "or give the decal "
                                "\"overlap\": \"allow\" if the image is to lie over itself there",
                                prefix, feature_name(input, j), feature_name(input, k)));
    }
  }
  if (input.features.size() == 1 && !(input.lone && input.lone->width > 0))
    return fail(
        ErrorCode::size_missing,
        prefix +
            "a single feature fixes neither size nor direction: give \"size\" (the image's width in scene "
            "units, over 0) and \"up\" (a direction), or pin a second feature");
  if (input.features.size() == 1) {
    // Near an edge the normal of the map's frame is another than the face's own.
    const auto corners = surface.corners(input.features[0].surface.face);
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    if (auto up = lone_up(input, normal); !up) return tl::unexpected<Error>(std::move(up.error()));
  }
  std::vector<std::vector<std::string>> parts;
  std::vector<std::uint32_t> component;
  for (std::size_t k = 0; k < input.features.size(); ++k) {
    const std::uint32_t c = surface.component[surface.faces[input.features[k].surface.face][0]];
    const auto part =
        static_cast<std::size_t>(std::find(component.begin(), component.end(), c) - component.begin());
    if (part == component.size()) {
      component.push_back(c);
      parts.emplace_back();
    }
    parts[part].push_back(feature_name(input, k));
  }
  if (parts.size() > 1) {
    std::string text;
    for (std::size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : " from ") + join(parts[i]);
    return fail(
        ErrorCode::features_disconnected,
        fmt::format(
            "{}the features lie on {} parts of the model that are not connected: {}; place them on one "
            "connected part, or make a decal for each{}",
            prefix, parts.size(), text, weld_note(surface)));
  }
  return {};
}

Result<Vec3> lone_up(const DecalInput& input, const Vec3& normal) {
  const Vec3 wanted = input.lone->up.stableNormalized();
  const Vec3 up = wanted - wanted.dot(normal) * normal;
  if (!(up.norm() > 1e-3))
    return fail(
        ErrorCode::size_missing,
        fmt::format("decal '{}': \"up\" points along the surface's normal at the feature; give a direction "
                    "along the surface",
                    input.name));
  return up.normalized();
}

double lone_scale(const DecalInput& input) {
  const ImageFrame& frame = input.region.frame();
  return frame.width / frame.pixels_per_unit() / input.lone->width;
}

Result<void> check_coverage(const DecalInput& input, double coverage) {
  if (coverage >= least_coverage) return {};
  return fail(
      ErrorCode::not_solved,
      fmt::format("decal '{}': only {:.2g} % of the image fits on the surface under it; make it smaller, or "
                  "check the features' places",
                  input.name, 100 * coverage));
}

}  // namespace applique
