#include "applique/decal.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "applique/decal_warnings.h"

#include "support/shapes.h"

namespace applique {
namespace {

constexpr ImageFrame frame{512, 512};

Region rectangle() {
  return *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, frame);
}

/// A star with five points, concave.
Region star() {
  std::vector<Pixel> contour;
  for (int k = 0; k < 10; ++k) {
    const double r = k % 2 == 0 ? 250 : 110, angle = std::numbers::pi * (0.2 * k - 0.5);
    contour.push_back({256 + r * std::cos(angle), 256 + r * std::sin(angle)});
  }
  return *Region::from_contour(contour, frame);
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

/// The largest distance, in pixels, of the map at the patch's vertices from `expected(surface point)`.
template <class Expected>
double map_error(const SurfaceMesh& surface, const DecalMap& map, Expected expected) {
  double worst = 0;
  for (PatchVertexId v : ids<PatchVertexId>(map.patch.vertices.size())) {
    if (!map.patch.vertices[v].valid()) continue;
    worst = std::max(worst, std::abs(map.image[v] - expected(surface.positions[map.patch.vertices[v]])));
  }
  return worst * frame.pixels_per_unit();
}

void expect_good(const DecalMap& map) {
  EXPECT_EQ(map.status, Coverage::covered);
  EXPECT_EQ(map.quality.flipped_plane, 0u);
  EXPECT_EQ(map.quality.flipped_image, 0u);
  EXPECT_GT(map.quality.coverage, 0.9999);
  for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 1e-8);
}

TEST(Decal, OnAPlaneIsTheExactSimilarity) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.3).weld();
  for (const Region& region : {rectangle(), star()}) {
    // One scene unit is 256 px; turned by 30 degrees about the middle.
    const Vec2 turn = std::polar(1.0, std::numbers::pi / 6);
    const auto image_of = [&](const Vec3& p) { return (Vec2(p.x() - 2, p.y() - 2)) * turn; };
    const auto place_of = [&](Pixel px) {
      const Vec2 z = frame.to_plane(px) / turn;
      return Vec3(z.real() + 2, z.imag() + 2, 0);
    };
    std::vector<Pin> pins;
    for (Pixel px : {Pixel{200, 220}, Pixel{320, 210}, Pixel{256, 330}, Pixel{250, 100}})
      pins.push_back({px, place_of(px)});
    for (std::size_t count : {2, 3, 4}) {
      const auto map = solve_decal(surface, decal(surface, region, {pins.begin(), pins.begin() + count}));
      ASSERT_TRUE(map.has_value()) << map.error().message;
      expect_good(*map);
      EXPECT_LT(map_error(surface, *map, image_of), 1e-7);
      EXPECT_LT(map->quality.l2_stretch, 1 + 1e-9);
    }
  }
}

TEST(Decal, WithOneFeatureTakesItsSizeAndDirection) {
  const SurfaceMesh surface = shapes::plane(30, 30, 4, 4, 0.2).weld();
  DecalInput input = decal(surface, rectangle(), {{{256, 256}, {2, 2, 0}}});
  input.lone = LoneFrame{2, {1, 0, 0.3}};  // up along +x: the image's right is -y
  const auto map = solve_decal(surface, input);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  expect_good(*map);
  EXPECT_LT(map_error(surface, *map, [](const Vec3& p) { return Vec2(-(p.y() - 2), p.x() - 2); }), 1e-7);
}

/// A wedge of two large faces: what faces another way, over the edge, does not change the size on the first.
TEST(Decal, WithOneFeatureHasItsSizeBesideAnEdge) {
  const SurfaceMesh surface =
      shapes::Soup{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {4, 0, -4}, {4, 4, -4}, {0, 0, -4}},
                   {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}, {0, 6, 4}, {0, 4, 1}}}
          .weld();
  for (const double width : {0.2, 1.0})
    for (const Vec3& at : {Vec3(3, 1.4, 0), Vec3(2, 2.6, 0)}) {
      DecalInput input = decal(surface, rectangle(), {{{256, 256}, at}});
      input.lone = LoneFrame{width, {0, 1, 0}};
      const auto map = solve_decal(surface, input);
      ASSERT_TRUE(map.has_value()) << map.error().message;
      expect_good(*map);
      const double half = 0.5 * width;  // scene units to one of the plane
      double area = 0;
      for (const PatchFaceId q : ids<PatchFaceId>(map->patch.faces.size())) {
        const auto& v = map->patch.faces[q].vertices;
        const auto corners = surface.corners(map->patch.faces[q].mesh_face);
        if (corners[0].z() + corners[1].z() + corners[2].z() != 0) continue;
        const Vec2 z = map->image[v[0]];
        area = cross(map->image[v[1]] - z, map->image[v[2]] - z) * half * half /
               (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
        EXPECT_NEAR(area, 1, 0.03);
      }
      EXPECT_GT(area, 0);
    }
}

TEST(Decal, UnrollsACylinder) {
  const double radius = 1;
  const SurfaceMesh surface = shapes::cylinder(96, 40, radius, 4).weld();
  const auto on = [&](double angle, double z) {
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  // The label's middle is at angle 180 degrees, on the mesh's own seam of parameters.
  std::vector<Pin> pins;
  for (const auto& [x, y] :
       std::vector<std::pair<double, double>>{{100, 150}, {400, 150}, {400, 350}, {100, 350}, {256, 256}})
    pins.push_back({{x, y}, on(std::numbers::pi + (x - 256) / 200, 2 - (y - 256) / 200)});
  const auto map = solve_decal(surface, decal(surface, rectangle(), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_EQ(map->quality.flipped_image, 0u);
  EXPECT_LT(map->quality.l2_stretch, 1.001);
  EXPECT_GT(map->quality.coverage, 0.9999);
}

TEST(Decal, RandomSimilaritiesOfTheFeaturesGiveRandomSimilaritiesOfTheMap) {
  const SurfaceMesh surface = shapes::plane(48, 48, 6, 6, 0.3).weld();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int run = 0; run < 12; ++run) {
    const Vec2 scale = std::polar(0.5 + unit(random), 6.28 * unit(random));
    const Vec2 shift(0.4 * unit(random), 0.4 * unit(random));
    const auto image_of = [&](const Vec3& p) { return scale * Vec2(p.x() - 3, p.y() - 3) + shift; };
    std::vector<Pin> pins;
    for (Pixel px : {Pixel{200, 220}, Pixel{310, 230}, Pixel{256, 330}}) {
      const Vec2 z = (frame.to_plane(px) - shift) / scale;
      pins.push_back({px, {z.real() + 3, z.imag() + 3, 0}});
    }
    const auto map = solve_decal(surface, decal(surface, star(), pins));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    EXPECT_LT(map_error(surface, *map, image_of), 1e-6);
  }
}

/// A mask on a bump with features pulled away from where the isometry would have them.
std::vector<Pin> bent_pins() {
  return {{{130, 150}, {-0.42, 0.40, 0}},
          {{380, 150}, {0.45, 0.38, 0}},
          {{256, 256}, {0.02, 0.05, 0.6}},
          {{180, 400}, {-0.3, -0.45, 0}},
          {{340, 390}, {0.28, -0.5, 0}}};
}

TEST(Decal, FeaturesAreExactOnABump) {
  const SurfaceMesh surface = shapes::bump(64, 0.6, 0.35).weld();
  for (std::size_t count : {2, 3, 5}) {
    const auto pins = bent_pins();
    const auto map = solve_decal(surface, decal(surface, rectangle(), {pins.begin(), pins.begin() + count}));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    EXPECT_EQ(map->quality.flipped_image, 0u);
    for (double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
  }
}

/// The image of a mirrored decal is turned over and so are its pixels: on the surface nothing changes.
TEST(Decal, MirroredOfTheMirroredImageIsTheSame) {
  const SurfaceMesh surface = shapes::bump(40, 0.6, 0.4).weld();
  const std::vector<Pixel> contour = {{40, 60}, {470, 100}, {400, 480}, {230, 430}, {90, 490}};
  const auto mirrored = [](Pixel at) { return Pixel{frame.width - at.x, at.y}; };
  std::vector<Pixel> mirrored_contour;
  for (const Pixel corner : contour) mirrored_contour.push_back(mirrored(corner));
  std::vector<Pin> mirrored_pins = bent_pins();
  for (Pin& pin : mirrored_pins) pin.image = mirrored(pin.image);
  constexpr ImageFrame mirrored_frame = {frame.width, frame.height, true};

  const auto plain = solve_decal(surface, decal(surface, *Region::from_contour(contour, frame), bent_pins()));
  const DecalInput input =
      decal(surface, *Region::from_contour(mirrored_contour, mirrored_frame), mirrored_pins);
  const auto turned = solve_decal(surface, input);
  ASSERT_TRUE(plain && turned);
  expect_good(*turned);
  ASSERT_EQ(turned->image.size(), plain->image.size());
  for (PatchVertexId v : ids<PatchVertexId>(plain->image.size())) {
    const Pixel here = mirrored_frame.to_pixel(turned->image[v]), there = frame.to_pixel(plain->image[v]);
    EXPECT_NEAR(here.x, frame.width - there.x, 1e-9);
    EXPECT_NEAR(here.y, there.y, 1e-9);
  }
  EXPECT_EQ(solve_decal(surface, decal(surface, rectangle(), mirrored_pins)).error().code,
            ErrorCode::features_mirrored);
}

TEST(Decal, MirroredWithOneFeatureKeepsItsUp) {
  const SurfaceMesh surface = shapes::plane(30, 30, 4, 4, 0.2).weld();
  constexpr ImageFrame mirrored = {512, 512, true};
  const Region whole = *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, mirrored);
  DecalInput input = decal(surface, whole, {{{256, 256}, {2, 2, 0}}});
  input.lone = LoneFrame{2, {0, 1, 0}};
  const auto map = solve_decal(surface, input);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  expect_good(*map);
  for (PatchVertexId v : ids<PatchVertexId>(map->image.size())) {
    const Vec3& p = surface.positions[map->patch.vertices[v]];
    const Pixel at = mirrored.to_pixel(map->image[v]);
    EXPECT_NEAR(at.x, 256 - 256 * (p.x() - 2), 1e-5) << "the image's right is the surface's left";
    EXPECT_NEAR(at.y, 256 - 256 * (p.y() - 2), 1e-5) << "up is up";
  }
}

/// The stress tells what the warp does: nothing where the features are at ease, and with one of them moved
/// aside on a plane that feature's shift, less the aligned rest.
TEST(Decal, TellsWhatTheFeaturesAskOfTheWarp) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const auto pins = [](double aside) {
    std::vector<Pin> list;
    for (const Pixel px : {Pixel{128, 128}, {384, 128}, {384, 384}, {128, 384}, {256, 256}})
      list.push_back({px, {1 + px.x / 256, 3 - px.y / 256, 0}});
    list.back().position.x() += aside;
    return list;
  };
  const auto solve = [&](double aside) {
    return *solve_decal(surface, decal(surface, rectangle(), pins(aside)));
  };
  const DecalMap at_ease = solve(0);
  ASSERT_EQ(at_ease.stress.features.size(), 5u);
  EXPECT_EQ(at_ease.stress.pairs.size(), 10u);
  for (const FeatureStress& feature : at_ease.stress.features) {
    EXPECT_LT(feature.shift, 1e-9);
    EXPECT_NEAR(feature.scale, 1, 1e-9);
  }
  // The alignment takes a fifth of the way over and shrinks what is too long.
  const DecalMap moved = solve(0.1);
  EXPECT_NEAR(moved.stress.features[4].shift, 0.08 * 2 / 2.008, 1e-6);
  EXPECT_TRUE(moved.warnings.empty());
}

/// Once for a feature, not again for its pairs; the way counts where the image does not lie over itself.
TEST(Decal, WarnsOfWhatIsExtreme) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4).weld();
  const DecalInput input = decal(surface, rectangle(), std::vector<Pin>(4, Pin{{128, 128}, {2, 2, 0}}));
  DecalMap map;
  map.stress.features = {{0.1, 1, 0}, {0.1, 1.2, 2.3}, {0.1, 3, -1}, {0.8, 1, 0}};
  map.stress.pairs = {{{0, 1}, 1, 2.5}, {{0, 2}, 0.2, 0}, {{0, 3}, 3.5, 2}};
  const std::vector<Warning> warnings = stress_warnings(input, map);
  ASSERT_EQ(warnings.size(), 3u);
  for (const Warning& warning : warnings) EXPECT_EQ(warning.code, "feature_stress");
  EXPECT_NE(warnings[0].message.find("feature 1 at"), std::string::npos);
  EXPECT_NE(warnings[0].message.find("turned by 132 degrees"), std::string::npos);
  EXPECT_NE(warnings[1].message.find("feature 3 at"), std::string::npos);
  EXPECT_NE(warnings[1].message.find("moved by 205 px"), std::string::npos);
  EXPECT_NE(warnings[2].message.find("feature 0 at (128.0, 128.0) and feature 2 at"), std::string::npos);
  map.groups = 2;
  EXPECT_EQ(stress_warnings(input, map).size(), 2u);
}

TEST(Decal, TracesWhatItWentThrough) {
  const SurfaceMesh surface = shapes::bump(64, 0.6, 0.35).weld();
  const DecalInput input = decal(surface, rectangle(), bent_pins());
  SolveTrace trace;
  SolveOptions options;
  options.trace = &trace;
  const auto map = solve_decal(surface, input, options);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  ASSERT_EQ(trace.paths.size(), map->graph.tree.size());
  for (std::size_t e = 0; e < trace.paths.size(); ++e) {
    ASSERT_GT(trace.paths[e].size(), 2u);
    const auto place = [&](std::uint32_t k) { return position_of(surface, input.features[k].surface); };
    const auto [i, j] = map->graph.tree[e];
    const Vec3 first = trace.paths[e].front(), last = trace.paths[e].back();
    EXPECT_TRUE((first == place(i) && last == place(j)) || (first == place(j) && last == place(i)));
  }
  ASSERT_EQ(trace.steps.size(), static_cast<std::size_t>(map->solves));
  const SolveTrace::Step& last = trace.steps.back();
  EXPECT_LT(trace.steps.front().patch.faces.size(), last.patch.faces.size());
  EXPECT_EQ(last.plane.raw(), map->plane.raw());
  EXPECT_EQ(last.image.raw(), map->image.raw());
  // The contour in the plane is what the warp takes onto the contour in the image.
  for (const Vec2 z : last.contour) EXPECT_LT(std::abs(input.region.signed_distance(map->warp(z))), 1e-4);
}

/// The image of surface points under a map, found by position: comparable between numberings.
std::vector<Vec2> sample_map(const SurfaceMesh& surface, const DecalMap& map,
                             const std::vector<Vec3>& places) {
  std::vector<Vec2> samples;
  for (const Vec3& place : places) {
    const SurfacePoint point = shapes::nearest(surface, place);
    Vec2 image = 100;
    for (const PatchFace& face : map.patch.faces) {
      if (face.mesh_face != point.face) continue;
      Vec2 plane = 0;
      for (int k = 0; k < 3; ++k) plane += point.barycentric[k] * map.plane[face.vertices[k]];
      image = map.warp(plane);
    }
    samples.push_back(image);
  }
  return samples;
}

std::vector<Vec3> bump_places() {
  std::vector<Vec3> places;
  for (double x : {-0.4, -0.13, 0.07, 0.33})
    for (double y : {-0.31, -0.02, 0.21, 0.41})
      places.emplace_back(x, y, 0.6 * std::exp(-(x * x + y * y) / 0.1225));
  return places;
}

double largest_difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst * frame.pixels_per_unit();
}

TEST(Decal, DoesNotDependOnTheOrderOfTrianglesVerticesOrFeatures) {
  const shapes::Soup soup = shapes::bump(64, 0.6, 0.35);
  const SurfaceMesh surface = soup.weld();
  const auto map = solve_decal(surface, decal(surface, rectangle(), bent_pins()));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  const std::vector<Vec2> expected = sample_map(surface, *map, bump_places());
  std::mt19937 random(2);
  for (int run = 0; run < 5; ++run) {
    std::vector<std::uint32_t> order(soup.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), random);
    shapes::Soup shuffled;
    shuffled.positions.resize(order.size());
    for (std::size_t v = 0; v < order.size(); ++v) shuffled.positions[order[v]] = soup.positions[v];
    for (const auto& t : soup.triangles) {
      const auto turn = static_cast<unsigned>(random() % 3);
      shuffled.triangles.push_back({order[t[turn]], order[t[(turn + 1) % 3]], order[t[(turn + 2) % 3]]});
    }
    std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
    std::vector<Pin> pins = bent_pins();
    std::shuffle(pins.begin(), pins.end(), random);
    const SurfaceMesh other = shuffled.weld();
    const auto again = solve_decal(other, decal(other, rectangle(), pins));
    ASSERT_TRUE(again.has_value()) << again.error().message;
    EXPECT_LT(largest_difference(sample_map(other, *again, bump_places()), expected), 0.05);
  }
}

TEST(Decal, DoesNotDependOnARigidMotionOrScalingOfTheModel) {
  const shapes::Soup soup = shapes::bump(64, 0.6, 0.35);
  const SurfaceMesh surface = soup.weld();
  const auto map = solve_decal(surface, decal(surface, rectangle(), bent_pins()));
  ASSERT_TRUE(map.has_value());
  const std::vector<Vec2> expected = sample_map(surface, *map, bump_places());
  for (const double scale : {1e-3, 1.0, 250.0}) {
    const Eigen::AngleAxisd turn(1.1, Vec3(1, -2, 0.5).normalized());
    const auto move = [&](const Vec3& p) -> Vec3 { return scale * (turn * p + Vec3(3, -1, 2)); };
    shapes::Soup moved = soup;
    for (Vec3& p : moved.positions) p = move(p);
    std::vector<Pin> pins = bent_pins();
    for (Pin& pin : pins) pin.position = move(position_of(surface, shapes::nearest(surface, pin.position)));
    std::vector<Vec3> places;
    for (const Vec3& p : bump_places())
      places.push_back(move(position_of(surface, shapes::nearest(surface, p))));
    const SurfaceMesh other = moved.weld();
    const auto again = solve_decal(other, decal(other, rectangle(), pins));
    ASSERT_TRUE(again.has_value());
    EXPECT_LT(largest_difference(sample_map(other, *again, places), expected), 0.05);
  }
}

TEST(Decal, BridgesASmallHole) {
  shapes::Soup soup = shapes::plane(40, 40, 4, 4);
  std::erase_if(soup.triangles, [&](const auto& t) {
    const Vec3 centre = (soup.positions[t[0]] + soup.positions[t[1]] + soup.positions[t[2]]) / 3;
    return (centre - Vec3(2, 2, 0)).cwiseAbs().maxCoeff() < 0.15;
  });
  const SurfaceMesh surface = soup.weld();
  const auto at = [](Pixel px) {
    const Vec2 z = frame.to_plane(px);
    return Vec3(z.real() + 2, z.imag() + 2, 0);
  };
  std::vector<Pin> pins;
  for (Pixel px : {Pixel{100, 256}, Pixel{400, 256}}) pins.push_back({px, at(px)});
  const auto map = solve_decal(surface, decal(surface, rectangle(), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_LT(map_error(surface, *map, [](const Vec3& p) { return Vec2(p.x() - 2, p.y() - 2); }), 1e-7);
  // What is not shown is the hole: a square of (2 cells)^2 or so out of 40 x 40 quarters.
  EXPECT_NEAR(map->quality.coverage, 1 - 0.2 * 0.2 / 4, 0.011);
  for (PatchFaceId q : ids<PatchFaceId>(map->patch.faces.size()))
    if (!map->patch.faces[q].mesh_face.valid()) {
      EXPECT_FALSE(map->textured[q]);
    }
}

TEST(Decal, EndsAtTheBoundaryOfTheSurface) {
  const SurfaceMesh surface = shapes::plane(20, 20, 2, 2).weld();
  const auto map = solve_decal(
      surface, decal(surface, rectangle(), {{{100, 256}, {0.1, 1, 0}}, {{356, 256}, {1.1, 1, 0}}}));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->status, Coverage::clipped_by_boundary);
  EXPECT_LT(map->quality.coverage, 0.95);
  ASSERT_EQ(map->warnings.size(), 1u);
  EXPECT_EQ(map->warnings[0].code, "clipped_by_boundary");
}

TEST(Decal, GoesRoundAClosedSurfaceOnlyOnce) {
  const SurfaceMesh surface = shapes::sphere(4, 1).weld();
  // The image is far larger than the sphere.
  const auto map = solve_decal(
      surface, decal(surface, rectangle(), {{{246, 256}, {-0.2, 0, 0.98}}, {{266, 256}, {0.2, 0, 0.98}}}));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_NE(map->status, Coverage::covered);
  EXPECT_NE(map->status, Coverage::not_converged);
  EXPECT_LE(map->patch.faces.size(), surface.faces.size());
}

TEST(Decal, IsNotLedRoundTheBackByFeaturesThatAreNearThere) {
  // Eight features round one, so far from it that each is nearer to the next by the far side of the sphere.
  const SurfaceMesh mesh = shapes::sphere(4, 1).weld();
  constexpr double reach = 2.4;
  std::vector<Pixel> contour;
  for (int k = 0; k < 48; ++k) {
    const double angle = k * std::numbers::pi / 24;
    contour.push_back({256 + 220 * std::cos(angle), 256 + 220 * std::sin(angle)});
  }
  std::vector<Pin> pins = {{{256, 256}, {0, 0, 1}}};
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.1 + k * std::numbers::pi / 4;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    pins.push_back({{256 + 200 * out.x(), 256 - 200 * out.y()},
                    std::sin(reach) * out + std::cos(reach) * Vec3::UnitZ()});
  }
  const auto map = solve_decal(mesh, decal(mesh, *Region::from_contour(contour, frame), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  EXPECT_EQ(map->sheets, 1U);
  EXPECT_EQ(map->quality.flipped_plane + map->quality.flipped_image, 0U);
  EXPECT_LT(map->quality.coverage, 1.005);
  EXPECT_LT(map->quality.l2_stretch, 2);
}

TEST(Decal, CostDoesNotFollowTheSurface) {
  // The same small decal on a plane and on one with 16 times the area: the patch is the same.
  std::size_t faces = 0;
  for (const int cells : {40, 160}) {
    const double size = cells / 10.0;
    const SurfaceMesh surface = shapes::plane(cells, cells, size, size).weld();
    const auto map =
        solve_decal(surface, decal(surface, star(), {{{200, 256}, {1.8, 2, 0}}, {{312, 256}, {2.2, 2, 0}}}));
    ASSERT_TRUE(map.has_value());
    if (faces == 0) faces = map->patch.faces.size();
    EXPECT_EQ(map->patch.faces.size(), faces);
  }
}

void expect_error(const SurfaceMesh& surface, const DecalInput& input, ErrorCode code,
                  const std::string& part) {
  const auto map = solve_decal(surface, input);
  ASSERT_FALSE(map.has_value());
  EXPECT_EQ(map.error().code, code);
  EXPECT_NE(map.error().message.find(part), std::string::npos) << map.error().message;
  EXPECT_NE(map.error().message.find("decal 'test'"), std::string::npos);
}

TEST(DecalErrors, NameTheCulprit) {
  const SurfaceMesh surface = shapes::plane(20, 20, 4, 4).weld();
  expect_error(surface, decal(surface, star(), {{{256, 256}, {2, 2, 0}}, {{20, 40}, {1, 3, 0}}}),
               ErrorCode::feature_outside_region, "feature 1 at (20.0, 40.0): outside the contour by");
  expect_error(surface, decal(surface, star(), {{{256, 256}, {2, 2, 0}}, {{256, 256}, {1, 3, 0}}}),
               ErrorCode::features_coincide, "one spot of the image");
  expect_error(surface, decal(surface, star(), {{{256, 256}, {2, 2, 0}}, {{200, 256}, {2, 2, 0}}}),
               ErrorCode::features_coincide, "feature 0 at (256.0, 256.0) and feature 1 at (200.0, 256.0)");
  expect_error(surface, decal(surface, star(), {{{256, 256}, {2, 2, 0}}}), ErrorCode::size_missing,
               "\"size\"");
  expect_error(surface,
               decal(surface, rectangle(),
                     {{{156, 156}, {2.5, 2.5, 0}}, {{356, 156}, {1.5, 2.5, 0}}, {{256, 356}, {2, 1.5, 0}}}),
               ErrorCode::features_mirrored, "mirror");
  DecalInput lone = decal(surface, star(), {{{256, 256}, {2, 2, 0}}});
  lone.lone = LoneFrame{1, {0, 0, 1}};
  expect_error(surface, lone, ErrorCode::size_missing, "along the surface's normal");
}

TEST(DecalErrors, UpAlongAFlatFacesNormalIsTurnedDownBesideAnEdgeToo) {
  // Two squares at a right angle: the mean normal round the feature is not its face's own.
  const std::vector<Vec3> positions = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {1, 0, 0}, {1, 1, 0}};
  const SurfaceMesh surface = weld_surface(
      positions, std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}});
  for (const double x : {0.1, 0.9, 0.999}) {
    DecalInput lone = decal(surface, rectangle(), {{{256, 256}, {x, 0.5, 1}}});
    lone.lone = LoneFrame{0.5, {0, 0, 1}};
    expect_error(surface, lone, ErrorCode::size_missing, "along the surface's normal");
  }
}

TEST(DecalErrors, TurnDownAnImageFarLargerThanTheSurface) {
  const SurfaceMesh surface = shapes::plane(8, 8, 1, 1).weld();
  DecalInput lone = decal(surface, rectangle(), {{{256, 256}, {0.5, 0.5, 0}}});
  lone.lone = LoneFrame{1000, {0, 1, 0}};
  expect_error(surface, lone, ErrorCode::not_solved, "make it smaller");
}

TEST(Decal, WarnsOfFeaturesThatPullTheImageOverItself) {
  const SurfaceMesh surface = shapes::sphere(4, 1).weld();
  // The inner two of four features on a row are swapped.
  const auto at = [](double x) { return Vec3(std::sin(x), 0, std::cos(x)); };
  const auto map = solve_decal(
      surface,
      decal(surface, rectangle(),
            {{{100, 256}, at(-0.6)}, {{200, 256}, at(0.2)}, {{312, 256}, at(-0.2)}, {{412, 256}, at(0.6)}}));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  for (double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-6);
  EXPECT_TRUE(std::any_of(map->warnings.begin(), map->warnings.end(),
                          [](const Warning& warning) { return warning.code == "feature_stress"; }));
}

TEST(DecalErrors, NameTheFeaturesOnDisconnectedParts) {
  shapes::Soup two = shapes::plane(4, 4, 1, 1);
  const shapes::Soup other = shapes::plane(4, 4, 1, 1);
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 25, t[1] + 25, t[2] + 25});
  for (const Vec3& p : other.positions) two.positions.push_back(p + Vec3(3, 0, 0));
  const SurfaceMesh surface = two.weld();
  expect_error(
      surface, decal(surface, rectangle(), {{{100, 256}, {0.5, 0.5, 0}}, {{300, 256}, {3.5, 0.5, 0}}}),
      ErrorCode::features_disconnected, "feature 0 at (100.0, 256.0) from feature 1 at (300.0, 256.0)");
}

/// Two squares beside each other and a fin on the edge between them.
TEST(DecalErrors, TellOfEdgesThatWereCutOpen) {
  const SurfaceMesh surface =
      shapes::Soup{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {1, 0.5, 1}},
                   {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}, {1, 2, 6}}}
          .weld();
  ASSERT_EQ(surface.cut_edges, 1u);
  expect_error(surface,
               decal(surface, rectangle(), {{{100, 256}, {0.5, 0.5, 0}}, {{300, 256}, {1.5, 0.5, 0}}}),
               ErrorCode::features_disconnected, "are cut open: 1 of them");
}

}  // namespace
}  // namespace applique
