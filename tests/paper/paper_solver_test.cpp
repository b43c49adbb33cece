#include "applique/paper/paper_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace applique {
namespace {

constexpr ImageFrame frame{512, 512};

Region region_of(const std::vector<Pixel>& contour) {
  return *Region::from_contour(contour, frame);
}

Region rectangle() {
  return region_of({{0, 0}, {512, 0}, {512, 512}, {0, 512}});
}

/// The vertex nearest to a place, as a surface point.
SurfacePoint vertex_near(const SurfaceMesh& surface, const Vec3& place) {
  std::size_t best = 0;
  for (std::size_t v = 0; v < surface.positions.size(); ++v)
    if ((surface.positions[VertexId(v)] - place).norm() < (surface.positions[VertexId(best)] - place).norm())
      best = v;
  SurfacePoint point{surface.vertex_face[VertexId(best)], {0, 0, 0}};
  for (int k = 0; k < 3; ++k) point.barycentric[k] = surface.faces[point.face][k] == VertexId(best) ? 1 : 0;
  return point;
}

struct Pin {
  Pixel image;
  Vec3 position;
};

DecalInput decal(const SurfaceMesh& surface, Region region, const std::vector<Pin>& pins) {
  DecalInput input{"test", std::move(region), {}, {}};
  for (const Pin& pin : pins) input.features.push_back({pin.image, vertex_near(surface, pin.position)});
  return input;
}

double map_error(const SurfaceMesh& surface, const DecalMap& map,
                 const std::function<Vec2(const Vec3&)>& expected) {
  double worst = 0;
  for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size()))
    if (map.textured[q])
      for (PatchVertexId v : map.patch.faces[q].vertices)
        worst = std::max(worst, std::abs(map.image[v] - expected(surface.positions[map.patch.vertices[v]])));
  return worst * frame.pixels_per_unit();
}

/// What is wrong with a patch as a disc: V - E + F = 1, neighbours mutual, one boundary loop.
void expect_disc(const Patch& patch) {
  std::size_t sides = 0, rim = 0;
  std::vector<std::size_t> next(patch.vertices.size(), patch.vertices.size());
  std::size_t start = 0;
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size()))
    for (int k = 0; k < 3; ++k) {
      ++sides;
      const auto& face = patch.faces[q];
      const PatchFaceId across = face.neighbours[k];
      if (across.valid()) {
        const auto& back = patch.faces[across].neighbours;
        EXPECT_NE(std::find(back.begin(), back.end(), q), back.end());
        continue;
      }
      ++rim;
      start = face.vertices[(k + 1) % 3].value;
      EXPECT_EQ(next[start], patch.vertices.size());
      next[start] = face.vertices[(k + 2) % 3].value;
    }
  EXPECT_EQ(patch.vertices.size() + patch.faces.size(), (sides + rim) / 2 + 1);
  std::size_t loop = 0;
  for (std::size_t v = start; loop == 0 || (v != start && loop <= rim); v = next[v]) ++loop;
  EXPECT_EQ(loop, rim);
}

TEST(PaperSolver, OnAPlaneIsTheSimilarity) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const Vec2 turn = std::polar(1.0, std::numbers::pi / 2);
  const auto image_of = [&](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2) * turn; };
  // Paths along grid lines, so that the initial map is the similarity already.
  std::vector<Pin> pins;
  for (const Vec3& p : {Vec3(1.5, 1.5, 0), Vec3(2.4, 1.5, 0), Vec3(2.4, 2.6, 0), Vec3(1.5, 2.6, 0)})
    pins.push_back({frame.to_pixel(image_of(p)), p});
  const auto map = solve_decal_as_paper(surface, decal(surface, rectangle(), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_EQ(map->quality.flipped_plane + map->quality.flipped_image, 0u);
  EXPECT_NEAR(map->quality.coverage, 1, 1e-9);
  EXPECT_LT(map_error(surface, *map, image_of), 1e-6);
  EXPECT_TRUE(map->warnings.empty()) << map->warnings[0].message;
  expect_disc(map->patch);
}

TEST(PaperSolver, OnAnIrregularPlaneApproachesTheSimilarity) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.3).weld();
  const auto image_of = [&](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2); };
  for (const std::size_t count : {2, 3, 5}) {
    std::vector<Pin> pins;
    for (const Vec3& near :
         {Vec3(1.3, 1.4, 0), Vec3(2.6, 1.5, 0), Vec3(2.1, 2.7, 0), Vec3(1.2, 2.3, 0), Vec3(2.0, 1.9, 0)}) {
      const Vec3 p = position_of(surface, vertex_near(surface, near));
      pins.push_back({frame.to_pixel(image_of(p)), p});
    }
    pins.resize(count);
    const auto map = solve_decal_as_paper(surface, decal(surface, rectangle(), pins));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    EXPECT_EQ(map->status, Coverage::covered);
    EXPECT_EQ(map->quality.flipped_plane + map->quality.flipped_image, 0u);
    for (double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
    std::printf("%zu features: error %.4f px, L2 %.6f, %d solves\n", count,
                map_error(surface, *map, image_of), map->quality.l2_stretch, map->solves);
    EXPECT_LT(map_error(surface, *map, image_of), 1);
  }
}

TEST(PaperSolver, MayBeginWithAFeatureInsideAFaceOfTheOthers) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const auto image_of = [&](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2); };
  std::vector<Pin> pins;
  for (const Vec3& p :
       {Vec3(2, 2, 0), Vec3(2.6, 2.1, 0), Vec3(1.9, 2.6, 0), Vec3(1.4, 1.9, 0), Vec3(2.1, 1.4, 0)})
    pins.push_back({frame.to_pixel(image_of(p)), p});
  const auto map = solve_decal_as_paper(surface, decal(surface, rectangle(), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->status, Coverage::covered);
  for (double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
}

TEST(PaperSolver, CoversABumpWithTheFeaturesInPlace) {
  const SurfaceMesh surface = shapes::bump(48, 0.5, 0.35).weld();
  const DecalInput input = decal(surface, rectangle(),
                                 {{{130, 150}, {-0.38, 0.36, 0}},
                                  {{380, 150}, {0.40, 0.34, 0}},
                                  {{256, 256}, {0.02, 0.05, 0.5}},
                                  {{180, 400}, {-0.27, -0.40, 0}},
                                  {{340, 390}, {0.25, -0.45, 0}}});
  SolveOptions options;
  for (const Method method : {Method::paper, Method::applique}) {
    options.method = method;
    const auto map = solve_decal(surface, input, options);
    ASSERT_TRUE(map.has_value()) << map.error().message;
    std::printf("%s: L2 %.3f, angle %.3f, area %.3f, coverage %.5f, %d solves, %.2f s\n",
                method == Method::paper ? "paper" : "applique", map->quality.l2_stretch,
                map->quality.angle_distortion, map->quality.area_distortion, map->quality.coverage,
                map->solves, map->times.total);
    EXPECT_EQ(map->quality.flipped_plane + map->quality.flipped_image, 0u);
    EXPECT_GT(map->quality.coverage, 0.995);
    for (double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
    expect_disc(map->patch);
  }
}

/// A dumbbell between two points of the image: a straight neck, narrow as given.
Region dumbbell(Vec2 a, Vec2 b, double half_width) {
  const Vec2 along = (b - a) / std::abs(b - a), side = along * Vec2(0, 1);
  std::vector<Pixel> contour;
  const auto corner = [&](Vec2 at, double x, double y) {
    contour.push_back(frame.to_pixel(at + x * along + y * side));
  };
  corner(a, -0.15, -0.25);
  corner(a, 0.15, -half_width);
  corner(b, -0.15, -half_width);
  corner(b, 0.15, -0.25);
  corner(b, 0.15, 0.25);
  corner(b, -0.15, half_width);
  corner(a, 0.15, half_width);
  corner(a, -0.15, 0.25);
  return region_of(contour);
}

TEST(PaperSolver, RollsBackWhereThePatchWouldSplit) {
  // The path runs along the grid's edges, with a bend; the region's neck between the features is straight, so
  // that the embedded seed, which is as bent as the path, leaves it.
  const SurfaceMesh surface = shapes::plane(80, 80, 4, 4).weld();
  const auto image_of = [&](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2); };
  const Vec3 a(1.2, 1.6, 0), b(2.8, 2.4, 0);
  SolveTrace trace;
  SolveOptions options;
  options.trace = &trace;
  const auto map =
      solve_decal_as_paper(surface,
                           decal(surface, dumbbell(image_of(a), image_of(b), 0.06),
                                 {{frame.to_pixel(image_of(a)), a}, {frame.to_pixel(image_of(b)), b}}),
                           options);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  const auto rollbacks = std::count_if(trace.steps.begin(), trace.steps.end(),
                                       [](const SolveTrace::Step& step) { return step.lambda < 1; });
  std::printf("%td rollbacks in %zu steps, coverage %.4f, error %.4f px\n", rollbacks, trace.steps.size(),
              map->quality.coverage, map_error(surface, *map, image_of));
  EXPECT_GT(rollbacks, 0);
  EXPECT_EQ(trace.steps.back().lambda, 1);
  for (const SolveTrace::Step& step : trace.steps) expect_disc(step.patch);
  EXPECT_TRUE(map->warnings.empty()) << map->warnings[0].message;
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_NEAR(map->quality.coverage, 1, 1e-6);
  EXPECT_LT(map_error(surface, *map, image_of), 0.1);
}

TEST(PaperSolver, TurnsDownPathsThatCross) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const auto map = solve_decal_as_paper(surface, decal(surface, rectangle(),
                                                       {{{150, 350}, {1.5, 1.5, 0}},
                                                        {{350, 350}, {2.5, 1.5, 0}},
                                                        {{350, 150}, {1.5, 2.5, 0}},
                                                        {{150, 150}, {2.5, 2.5, 0}}}));
  ASSERT_FALSE(map.has_value());
  EXPECT_EQ(map.error().code, ErrorCode::not_solved);
  const auto says = [&](const char* text) { return map.error().message.find(text) != std::string::npos; };
  EXPECT_TRUE(says("crosses"));
  for (const char* feature : {"feature 0 at (150.0, 350.0)", "feature 1 at (350.0, 350.0)",
                              "feature 2 at (350.0, 150.0)", "feature 3 at (150.0, 150.0)"})
    EXPECT_TRUE(says(feature)) << feature;
  EXPECT_TRUE(says("another feature near (350.0, 250.0)") || says("another feature near (150.0, 250.0)"));
}

TEST(PaperSolver, AsksForAFeatureWhereAnIsolatedOneIsOutsideItsFace) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const auto map = solve_decal_as_paper(surface, decal(surface, rectangle(),
                                                       {{{100, 400}, {1.5, 1.5, 0}},
                                                        {{400, 400}, {2.5, 1.5, 0}},
                                                        {{250, 100}, {2, 2.5, 0}},
                                                        {{250, 380}, {2, 1.2, 0}}}));
  ASSERT_FALSE(map.has_value());
  EXPECT_EQ(map.error().code, ErrorCode::not_solved);
  EXPECT_NE(map.error().message.find("feature 3 at (250.0, 380.0) lies inside the face"), std::string::npos);
  EXPECT_NE(map.error().message.find("another feature near (250.0, 400.0)"), std::string::npos);
}

TEST(PaperSolver, AsksForAFeatureWhereTheContourLiesBetween) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const Region angle = region_of({{0, 0}, {100, 0}, {100, 412}, {512, 412}, {512, 512}, {0, 512}});
  const auto map = solve_decal_as_paper(
      surface, decal(surface, angle, {{{50, 100}, {1.5, 2.5, 0}}, {{400, 460}, {2.5, 1.5, 0}}}));
  ASSERT_FALSE(map.has_value());
  EXPECT_EQ(map.error().code, ErrorCode::not_solved);
  EXPECT_NE(map.error().message.find("the contour lies between feature 0 at (50.0, 100.0)"),
            std::string::npos);
}

TEST(PaperSolver, NeedsASecondFeatureAndDistinctVertices) {
  const SurfaceMesh surface = shapes::plane(10, 10, 4, 4).weld();
  DecalInput input = decal(surface, rectangle(), {{{256, 256}, {2, 2, 0}}});
  input.lone = LoneFrame{1, {0, 1, 0}};
  EXPECT_EQ(solve_decal_as_paper(surface, input).error().code, ErrorCode::not_solved);

  input.features.push_back({{300, 256}, shapes::nearest(surface, {2.05, 2.0, 0})});
  const auto near = solve_decal_as_paper(surface, input);
  ASSERT_FALSE(near.has_value());
  EXPECT_NE(near.error().message.find("the same vertex"), std::string::npos);

  input.features[1].surface = shapes::nearest(surface, {2.9, 2.05, 0});
  const auto snapped = solve_decal_as_paper(surface, input);
  ASSERT_TRUE(snapped.has_value()) << snapped.error().message;
  ASSERT_FALSE(snapped->warnings.empty());
  EXPECT_EQ(snapped->warnings[0].code, "feature_snapped");
  EXPECT_GT(snapped->quality.feature_residual[1], 1);
}

}  // namespace
}  // namespace applique
