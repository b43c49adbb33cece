#include "applique/rivals/rival_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "applique/rivals/exponential_map.h"
#include "applique/rivals/planar_map.h"
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

[[maybe_unused]] bool warns(const DecalMap& map, const char* code) {
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

TEST(Rivals, OnAPlaneAreTheSimilarity) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.3).weld();
  const Vec2 turn = std::polar(1.0, std::numbers::pi / 6);
  const auto image_of = [&](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2) * turn; };
  const auto pin = [&](const Vec3& p) { return Pin{frame.to_pixel(image_of(p)), p}; };
  const std::vector<Pin> pins = {pin({2.11, 1.93, 0}), pin({2.6, 2.3, 0}), pin({1.4, 1.5, 0}), pin({1.7, 2.5, 0})};
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
      for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 1e-6);
      EXPECT_TRUE(map.warnings.empty()) << map.warnings[0].message;
      expect_sound(surface, map);
    }
}

TEST(Rivals, FigureOnTheSharpBump) {
  const double h = std::getenv("H") ? std::atof(std::getenv("H")) : 1, w = std::getenv("W") ? std::atof(std::getenv("W")) : 0.3;
  const double size = std::getenv("S") ? std::atof(std::getenv("S")) : 1.6;
  const double x = std::getenv("X") ? std::atof(std::getenv("X")) : 0;
  const SurfaceMesh surface = shapes::bump(64, h, w).weld();
  for (SolveOptions options : all_rivals()) {
    options.planar.normal_limit = 180;
    auto map = solve(surface, lone_decal(surface, {x, 0.01, h * std::exp(-(x * x) / (w * w))}, size, {0, 1, 0}), options);
    print("bump", options, map);
  }
}

TEST(Rivals, FigureOnTheSphereCap) {
  const SurfaceMesh surface = shapes::sphere(std::getenv("L") ? std::atoi(std::getenv("L")) : 5, 1).weld();
  std::vector<Pixel> contour;
  for (int k = 0; k < 64; ++k) {
    const double angle = 2 * std::numbers::pi * k / 64;
    contour.push_back({256 + 256 * std::cos(angle), 256 + 256 * std::sin(angle)});
  }
  for (SolveOptions options : all_rivals()) {
    DecalInput input = decal(surface, *Region::from_contour(contour, frame), {{{256, 256}, {0, 0, 1}}});
    input.lone = LoneFrame{options.method == Method::planar ? 2 * std::sin(1.3) : 2.6, {0, 1, 0}};
    print("cap", options, solve(surface, input, options));
  }
}

}  // namespace
}  // namespace applique
