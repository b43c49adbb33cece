#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "applique/rivals/exponential_map.h"
#include "applique/rivals/planar_map.h"
#include "applique/rivals/rival_solver.h"
#include "applique/rivals/stroke_map.h"

#include "support/shapes.h"

namespace applique {
namespace {

constexpr ImageFrame frame{512, 512};
constexpr std::array rivals = {Method::planar, Method::expmap, Method::stroke};

Region rectangle() {
  return *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, frame);
}

struct Pin {
  Pixel image;
  Vec3 position;
};

DecalInput decal(const SurfaceMesh& surface, Region region, const std::vector<Pin>& pins) {
  DecalInput input{"test", std::move(region), {}, {}};
  for (const Pin& pin : pins) input.features.push_back({pin.image, shapes::nearest(surface, pin.position)});
  return input;
}

/// The whole image, `width` wide, its middle at `position`.
DecalInput lone_decal(const SurfaceMesh& surface, const Vec3& position, double width, const Vec3& up) {
  DecalInput input = decal(surface, rectangle(), {{{256, 256}, position}});
  input.lone = LoneFrame{width, up};
  return input;
}

/// Every rival, and both kinds of exponential map.
std::vector<SolveOptions> all_rivals() {
  std::vector<SolveOptions> all;
  for (Method method : rivals) {
    SolveOptions options;
    options.method = method;
    all.push_back(options);
  }
  all.push_back(all[1]);
  all.back().parents = Parents::one;
  return all;
}

std::string label(const SolveOptions& options) {
  return std::string(name_of(options.method)) + (options.parents == Parents::one ? ", one parent" : "");
}

DecalMap solve(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options) {
  auto map = solve_decal(surface, input, options);
  EXPECT_TRUE(map.has_value()) << map.error().message;
  return map ? std::move(*map) : DecalMap();
}

void print(const char* title, const SolveOptions& options, const DecalMap& map) {
  std::printf("%s, %s: L2 %.4f, Linf %.3f, %u flips, coverage %.4f, %.3f s\n", title, label(options).c_str(),
              map.quality.l2_stretch, map.quality.linf_stretch, map.quality.flipped_image,
              map.quality.coverage, map.times.total);
}

/// The largest distance, in pixels, of the map from `expected`.
template <class Expected>
double map_error(const SurfaceMesh& surface, const DecalMap& map, Expected expected) {
  double worst = 0;
  for (PatchVertexId v : ids<PatchVertexId>(map.patch.vertices.size()))
    worst = std::max(worst, std::abs(map.image[v] - expected(surface.positions[map.patch.vertices[v]])));
  return worst * frame.pixels_per_unit();
}

bool warns(const DecalMap& map, const char* code) {
  return std::any_of(map.warnings.begin(), map.warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

/// A patch over part of the surface: no face twice, neighbours mutual and true to the surface.
void expect_sound(const SurfaceMesh& surface, const DecalMap& map) {
  std::set<FaceId> over;
  for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    const PatchFace& face = map.patch.faces[q];
    EXPECT_TRUE(over.insert(face.mesh_face).second);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(map.patch.vertices[face.vertices[k]], surface.faces[face.mesh_face][k]);
      if (!face.neighbours[k].valid()) continue;
      const PatchFace& across = map.patch.faces[face.neighbours[k]];
      EXPECT_EQ(across.mesh_face, surface.neighbours[face.mesh_face][k]);
      EXPECT_EQ(across.neighbours[surface.neighbour_edges[face.mesh_face][k]], q);
    }
  }
  EXPECT_EQ(map.warp.steps, 0u);
  EXPECT_EQ(map.plane.raw(), map.image.raw());
}

/// The region of the largest disc in the image.
Region disc() {
  std::vector<Pixel> contour;
  for (int k = 0; k < 64; ++k) {
    const double angle = 2 * std::numbers::pi * k / 64;
    contour.push_back({256 + 256 * std::cos(angle), 256 + 256 * std::sin(angle)});
  }
  return *Region::from_contour(contour, frame);
}

TEST(Rivals, OnAPlaneAreTheSimilarity) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.3).weld();
  const Vec2 turn = std::polar(1.0, std::numbers::pi / 6);
  const auto image_of = [&](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2) * turn; };
  const auto pin = [&](const Vec3& p) { return Pin{frame.to_pixel(image_of(p)), p}; };
  // The first three on a line, the last far off it.
  const std::vector<Pin> pins = {pin({2.11, 1.93, 0}), pin({2.61, 2.23, 0}), pin({1.61, 1.63, 0}),
                                 pin({1.7, 2.7, 0})};
  for (const SolveOptions& options : all_rivals())
    for (std::size_t count = 1; count <= pins.size(); ++count) {
      DecalInput input = decal(surface, rectangle(), {pins.begin(), pins.begin() + count});
      if (count == 1) input.lone = LoneFrame{2, {0.5, std::sqrt(0.75), 0.4}};
      const DecalMap map = solve(surface, input, options);
      SCOPED_TRACE(label(options) + ", features: " + std::to_string(count));
      EXPECT_LT(map_error(surface, map, image_of), 1e-9 * frame.pixels_per_unit());
      EXPECT_EQ(map.status, Coverage::covered);
      EXPECT_NEAR(map.quality.coverage, 1, 1e-9);
      EXPECT_NEAR(map.quality.l2_stretch, 1, 1e-9);
      EXPECT_EQ(map.quality.flipped_image, 0u);
      for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 1e-9);
      EXPECT_TRUE(map.warnings.empty()) << map.warnings[0].message;
      expect_sound(surface, map);
    }
}

TEST(Rivals, MeetTheAnchorAndTellOfTheOthers) {
  const SurfaceMesh surface = shapes::sphere(4, 1).weld();
  // The second feature is nearest to the middle; the third cannot be met by a similarity.
  const DecalInput input = decal(surface, rectangle(),
                                 {{{100, 256}, {-0.5, 0, 0.8}},
                                  {{270, 250}, {0.02, 0.01, 1}},
                                  {{256, 100}, {0.1, 0.6, 0.8}},
                                  {{430, 256}, {0.6, 0, 0.8}}});
  for (const SolveOptions& options : all_rivals()) {
    const DecalMap map = solve(surface, input, options);
    SCOPED_TRACE(label(options));
    const auto& residual = map.quality.feature_residual;
    ASSERT_EQ(residual.size(), 4u);
    EXPECT_LT(residual[1], 1e-9);
    const double worst = *std::max_element(residual.begin(), residual.end());
    EXPECT_GT(worst, 1);
    EXPECT_LT(worst, 80);
    EXPECT_TRUE(warns(map, "features_missed"));
    expect_sound(surface, map);
  }
}

TEST(Rivals, MeetTheAnchorOnVerticesAndInFaces) {
  const SurfaceMesh surface = shapes::bump(40, 0.4, 0.4).weld();
  for (const SolveOptions& options : all_rivals())
    for (const Vec3& at : {Vec3(0.1, 0.05, 0.4), Vec3(0.113, 0.042, 0.4), Vec3(0.125, 0.05, 0.4)}) {
      const DecalMap map = solve(surface, lone_decal(surface, at, 0.8, {0, 1, 0}), options);
      EXPECT_LT(map.quality.feature_residual[0], 1e-9) << label(options);
      EXPECT_FALSE(warns(map, "features_missed"));
    }
}

TEST(Rivals, FillTheDisc) {
  // 1.205 rad: where the projection's L2 is that of the design's table. What is exact is known for both.
  const SurfaceMesh surface = shapes::sphere(5, 1).weld();
  DecalInput input = decal(surface, disc(), {{{256, 256}, {0, 0, 1}}});
  constexpr double reach = 1.205;
  const auto stretch = [&](const SolveOptions& options, double width) {
    input.lone = LoneFrame{width, {0, 1, 0}};
    const DecalMap map = solve(surface, input, options);
    print("sphere cap", options, map);
    EXPECT_EQ(map.status, Coverage::covered);
    EXPECT_NEAR(map.quality.coverage, 1, 1e-6);
    EXPECT_EQ(map.quality.flipped_image, 0u);
    return map.quality.l2_stretch;
  };
  const auto all = all_rivals();
  EXPECT_NEAR(stretch(all[0], 2 * std::sin(reach)), 1.134, 3e-3);
  EXPECT_LT(stretch(all[1], 2 * reach), 1.0105);
  EXPECT_LT(stretch(all[2], 2 * reach), 1.04);
  EXPECT_LT(stretch(all[3], 2 * reach), 1.02);
}

TEST(Rivals, CountWhatTheyTurnOverOnASharpBump) {
  constexpr double height = 0.8, width = 0.3;
  const SurfaceMesh surface = shapes::bump(64, height, width).weld();
  const Vec3 at(0.2, 0.01, height * std::exp(-0.2 * 0.2 / (width * width)));
  const DecalInput input = lone_decal(surface, at, 1.2, {0, 1, 0});
  auto all = all_rivals();
  all[0].planar.normal_limit = 180;
  std::vector<MapQuality> quality;
  for (const SolveOptions& options : all) {
    const DecalMap map = solve(surface, input, options);
    print("sharp bump", options, map);
    quality.push_back(map.quality);
    // Its own count of what the patch turns over.
    std::uint32_t flips = 0;
    for (const PatchFace& face : map.patch.faces) {
      const auto& v = face.vertices;
      flips += cross(map.image[v[1]] - map.image[v[0]], map.image[v[2]] - map.image[v[0]]) <= 0 ? 1 : 0;
    }
    EXPECT_EQ(map.quality.flipped_image, flips) << label(options);
    EXPECT_EQ(warns(map, "flipped_triangles"), flips > 0) << label(options);
  }
  EXPECT_GT(quality[0].flipped_image, 300u) << "a projection without a limit folds";
  EXPECT_GT(quality[0].l2_stretch, 4);
  EXPECT_LE(quality[1].flipped_image, 2u);
  EXPECT_LT(quality[1].l2_stretch, 1.2);
  EXPECT_LT(quality[2].l2_stretch, 1.85);
  EXPECT_GT(quality[3].flipped_image, 10 * quality[1].flipped_image);

  const DecalMap limited = solve(surface, input, all_rivals()[0]);
  EXPECT_EQ(limited.quality.flipped_image, 0u);
  EXPECT_EQ(limited.status, Coverage::clipped_by_limits);
  const DecalMap ours = solve(surface, input, {});
  print("sharp bump", {}, ours);
  EXPECT_EQ(ours.quality.flipped_image, 0u);
  for (const MapQuality& rival : quality) EXPECT_LT(ours.quality.l2_stretch, rival.l2_stretch);
}

TEST(PlanarMap, KeepsToItsLimits) {
  const SurfaceMesh surface = shapes::sphere(4, 1).weld();
  const DecalInput input = lone_decal(surface, {0.3, 0.2, 0.93}, 1.8, {0, 1, 0});
  const TangentFrame at = tangent_frame(surface, input.features[0].surface);
  SolveOptions options;
  options.method = Method::planar;
  const double free = solve(surface, input, options).quality.coverage;
  for (const auto& [depth, degrees] : {std::pair(0.1, 90.0), std::pair(1.0, 30.0)}) {
    options.planar = {depth, degrees};
    const DecalMap map = solve(surface, input, options);
    for (const PatchFace& face : map.patch.faces) {
      for (const Vec3& p : surface.corners(face.mesh_face)) EXPECT_LE(std::abs(at.height(p)), depth);
      EXPECT_GT(face_normal(surface, face.mesh_face).dot(at.normal),
                std::cos(degrees * std::numbers::pi / 180) - 1e-9);
    }
    EXPECT_EQ(map.status, Coverage::clipped_by_limits);
    EXPECT_TRUE(warns(map, "clipped_by_limits"));
    EXPECT_LT(map.quality.coverage, 0.9 * free);
    EXPECT_GT(map.quality.coverage, 0.1);
  }
}

TEST(PlanarMap, DoesNotReachThroughToTheOtherSide) {
  // Two sheets of one part, bent round: the projection's depth spans both, the connection does not.
  const SurfaceMesh surface = shapes::cylinder(32, 10, 0.2, 2).weld();
  SolveOptions options;
  options.method = Method::planar;
  const DecalMap map = solve(surface, lone_decal(surface, {0.2, 0.01, 1}, 1, {0, 0, 1}), options);
  for (VertexId v : map.patch.vertices) EXPECT_GT(surface.positions[v].x(), -0.05);
}

TEST(StrokeMap, OnACylinderIsTheIsometry) {
  // A ribbon that winds half round, an eighth as wide as long.
  const SurfaceMesh surface = shapes::cylinder(96, 96, 1, 4).weld();
  const Region ribbon = *Region::from_contour({{0, 224}, {512, 224}, {512, 288}, {0, 288}}, frame);
  const double width = std::numbers::pi, rise = 0.3;
  const Vec2 along = Vec2(1, rise) / std::hypot(1, rise);
  const auto image_of = [&](const Vec3& p) {
    return Vec2(std::atan2(p.y(), p.x()), p.z() - 2) / along * (2 / width);
  };
  const auto place_of = [&](double x) {
    const Vec2 p = x * along * (width / 2);
    return Vec3(std::cos(p.real()), std::sin(p.real()), 2 + p.imag());
  };
  SolveOptions options;
  options.method = Method::stroke;
  const auto pin = [&](double x) { return Pin{frame.to_pixel(x), place_of(x)}; };
  for (const auto& pins : {std::vector{pin(0)}, {pin(0), pin(0.7)}, {pin(-0.8), pin(0.1), pin(0.6)}}) {
    DecalInput input = decal(surface, ribbon, pins);
    input.lone = LoneFrame{width, {0, -rise, 1}};
    const DecalMap map = solve(surface, input, options);
    print("ribbon on a cylinder", options, map);
    EXPECT_LT(map_error(surface, map, image_of), 1);
    EXPECT_LT(map.quality.l2_stretch, 1 + 1e-5);
    EXPECT_EQ(map.status, Coverage::covered);
    EXPECT_NEAR(map.quality.coverage, 1, 1e-3);
    EXPECT_EQ(map.quality.flipped_image, 0u);
  }
}

TEST(StrokeMap, FollowsTheFeaturesAlongItsAxis) {
  // Unequal gaps: the axis is stretched between the features, and meets them all.
  const SurfaceMesh surface = shapes::plane(60, 60, 6, 6, 0.2).weld();
  SolveOptions options;
  options.method = Method::stroke;
  const DecalMap map =
      solve(surface,
            decal(surface, rectangle(),
                  {{{106, 256}, {1.5, 3, 0}}, {{256, 256}, {3.1, 3, 0}}, {{406, 256}, {4.2, 3, 0}}}),
            options);
  for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 1);
  options.method = Method::expmap;
  const DecalMap radial =
      solve(surface,
            decal(surface, rectangle(),
                  {{{106, 256}, {1.5, 3, 0}}, {{256, 256}, {3.1, 3, 0}}, {{406, 256}, {4.2, 3, 0}}}),
            options);
  EXPECT_GT(*std::max_element(radial.quality.feature_residual.begin(), radial.quality.feature_residual.end()),
            10);
}

TEST(Rivals, CostWhatTheDecalCovers) {
  const auto visited = [](int cells, const SolveOptions& options) {
    const SurfaceMesh surface = shapes::plane(cells, cells, 0.1 * cells, 0.1 * cells).weld();
    const double middle = 0.05 * cells;
    const DecalInput input = lone_decal(surface, {middle + 0.03, middle + 0.01, 0}, 1, {0, 1, 0});
    const auto task = make_task(surface, input);
    const auto map = options.method == Method::planar   ? project_planar(surface, *task)
                     : options.method == Method::expmap ? map_exponential(surface, *task, options.parents)
                                                        : map_along_stroke(surface, *task);
    return map->faces.size();
  };
  for (const SolveOptions& options : all_rivals()) {
    const std::size_t small = visited(40, options);
    EXPECT_EQ(visited(240, options), small) << label(options);
    EXPECT_LT(small, 2u * 200u) << label(options) << ": the region's own faces and a margin";
  }
}

TEST(Rivals, ReachARegionAmongCoarseFaces) {
  // No vertex lies in the region, which runs over several faces.
  const SurfaceMesh surface = shapes::plane(4, 4, 4, 4).weld();
  for (const SolveOptions& options : all_rivals()) {
    const DecalMap map = solve(surface, lone_decal(surface, {1.45, 1.55, 0}, 0.8, {0.3, 1, 0}), options);
    EXPECT_EQ(map.status, Coverage::covered) << label(options);
    EXPECT_NEAR(map.quality.coverage, 1, 1e-9) << label(options);
  }
}

TEST(Rivals, SayWhereTheSurfaceEnds) {
  const SurfaceMesh plane = shapes::plane(20, 20, 2, 2).weld(), ball = shapes::sphere(3, 0.3).weld(),
                    tube = shapes::cylinder(40, 60, 0.3, 6).weld();
  for (const SolveOptions& options : all_rivals()) {
    SCOPED_TRACE(label(options));
    const DecalMap edge = solve(plane, lone_decal(plane, {0.01, 1.02, 0}, 1, {0, 1, 0}), options);
    EXPECT_EQ(edge.status, Coverage::clipped_by_boundary);
    EXPECT_NEAR(edge.quality.coverage, 0.51, 1e-6);
    if (options.method == Method::planar) continue;
    const DecalMap closed = solve(ball, lone_decal(ball, {0, 0, 0.3}, 3, {0, 1, 0}), options);
    EXPECT_EQ(closed.status, Coverage::clipped_closed);
    const DecalMap round = solve(tube, lone_decal(tube, {0.3, 0.01, 3}, 3, {0, 0, 1}), options);
    EXPECT_EQ(round.status, Coverage::clipped_by_cover);
    EXPECT_EQ(round.warnings[0].message.find("\"overlap\""), std::string::npos) << "of no use here";
  }
}

TEST(Rivals, TurnDownWhatTheyCannotMap) {
  const SurfaceMesh surface = shapes::plane(20, 20, 2, 2).weld();
  const DecalInput along_normal = lone_decal(surface, {1, 1, 0}, 1, {0, 0, 1});
  const DecalInput mirrored =
      decal(surface, rectangle(),
            {{{150, 150}, {1.4, 1.4, 0}}, {{350, 150}, {0.6, 1.4, 0}}, {{256, 350}, {1, 0.6, 0}}});
  const DecalInput huge = lone_decal(surface, {1, 1, 0}, 100, {0, 1, 0});
  for (const SolveOptions& options : all_rivals()) {
    SCOPED_TRACE(label(options));
    const auto fails_with = [&](const DecalInput& input, ErrorCode code) {
      const auto map = solve_decal(surface, input, options);
      ASSERT_FALSE(map.has_value());
      EXPECT_EQ(map.error().code, code) << map.error().message;
      EXPECT_NE(map.error().message.find("decal 'test'"), std::string::npos);
    };
    fails_with(along_normal, ErrorCode::size_missing);
    if (options.method != Method::stroke) fails_with(mirrored, ErrorCode::features_mirrored);
    fails_with(huge, ErrorCode::not_solved);
  }
}

}  // namespace
}  // namespace applique
