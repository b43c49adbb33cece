#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "applique/decal.h"

#include "support/shapes.h"
#include "support/thorough.h"

namespace applique {
namespace {

constexpr double pi = std::numbers::pi;

struct Pin {
  Pixel image;
  Vec3 position;
  double depth = 0;
};

DecalInput decal(const SurfaceMesh& surface, Region region, const std::vector<Pin>& pins) {
  DecalInput input{"test", std::move(region), {}, {}};
  for (const Pin& pin : pins)
    input.features.push_back({pin.image, shapes::nearest(surface, pin.position), pin.depth});
  return input;
}

void expect_exact_and_unfolded(const DecalMap& map) {
  EXPECT_EQ(map.quality.flipped_plane, 0U);
  EXPECT_EQ(map.quality.flipped_image, 0U);
  for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 1e-8);
}

/// The textured faces that lie over one surface face, for every surface face that has several.
std::vector<std::vector<PatchFaceId>> stacks(const DecalMap& map) {
  std::map<FaceId, std::vector<PatchFaceId>> over;
  for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size()))
    if (map.textured[q]) over[map.patch.faces[q].mesh_face].push_back(q);
  std::vector<std::vector<PatchFaceId>> result;
  for (auto& [face, stack] : over)
    if (stack.size() > 1) result.push_back(std::move(stack));
  return result;
}

Vec2 image_middle(const DecalMap& map, PatchFaceId q) {
  const auto& v = map.patch.faces[q].vertices;
  return (map.image[v[0]] + map.image[v[1]] + map.image[v[2]]) / 3.0;
}

/// A straight ribbon of 1200 x 100 pixels.
constexpr ImageFrame ribbon_frame{1200, 100};
Region ribbon() {
  return *Region::from_contour({{0, 0}, {1200, 0}, {1200, 100}, {0, 100}}, ribbon_frame);
}

/// A belt of one and a half times the way round, its middle pinned every 45 degrees; later is on top if
/// `rising`.
std::vector<Pin> belt(bool rising) {
  std::vector<Pin> pins;
  for (int k = 0; k <= 12; ++k) {
    const double angle = 2 * pi * (k + 0.25) / 8;
    pins.push_back({{50 + 1100.0 / 12 * k, 50},
                    {std::cos(angle), std::sin(angle), 2.02},
                    rising ? double(k) : double(-k)});
  }
  return pins;
}

TEST(Overlap, ABeltGoesRoundACylinderOneAndAHalfTimes) {
  const SurfaceMesh surface = shapes::cylinder(96, 40, 1, 4).weld();
  for (const bool rising : {true, false}) {
    SolveOptions options;
    options.overlap = Overlap::allow;
    const auto map = solve_decal(surface, decal(surface, ribbon(), belt(rising)), options);
    ASSERT_TRUE(map.has_value()) << map.error().message;
    expect_exact_and_unfolded(*map);
    EXPECT_EQ(map->status, Coverage::covered);
    EXPECT_GT(map->quality.coverage, 0.9999);
    EXPECT_LT(map->quality.coverage, 1.0001);
    EXPECT_EQ(map->sheets, 2U);
    EXPECT_EQ(map->groups, 1U);                 // in the plane nothing overlaps
    EXPECT_LT(map->quality.l2_stretch, 1.001);  // each sheet is unrolled
    const auto overlaps = stacks(*map);
    EXPECT_GT(overlaps.size(), 300U);
    for (const auto& stack : overlaps) {
      ASSERT_EQ(stack.size(), 2U);
      // A turn apart along the ribbon, and the one further along is on top, or below.
      const double x0 = image_middle(*map, stack[0]).real(), x1 = image_middle(*map, stack[1]).real();
      EXPECT_NEAR(std::abs(x1 - x0), 2.0 / 1200 * 1100 / 12 * 8, 0.02);
      EXPECT_EQ(map->depth[stack[0]] < map->depth[stack[1]], (x0 < x1) == rising);
    }
  }
}

/// A broad label, pinned every two radians: its conformal maps on the way there are far off, and each sheet
/// more must not throw it back to them.
TEST(Overlap, ABroadLabelGoesRoundACylinderOverItself) {
  const SurfaceMesh surface = shapes::cylinder(96, 60, 1, 8).weld();
  const Region label = *Region::from_contour({{0, 0}, {1000, 0}, {1000, 512}, {0, 512}}, {1000, 512});
  std::vector<Pin> pins;
  for (int k = 0; k < 5; ++k)
    pins.push_back({{100.0 + 200 * k, 256}, {std::cos(2.0 * k), std::sin(2.0 * k), 4}, double(k)});
  SolveOptions options;
  options.overlap = Overlap::allow;
  const auto map = solve_decal(surface, decal(surface, label, pins), options);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  expect_exact_and_unfolded(*map);
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_LT(map->quality.l2_stretch, 1.001);
  EXPECT_GT(map->quality.coverage, 0.9999);
  EXPECT_EQ(map->sheets, 2U);
  EXPECT_LT(map->solves, 30);
}

/// A ribbon wound three times round a tube whose triangles are as high as its turns together: their paths
/// share vertices and triangles.
TEST(Overlap, AHelixWindsRoundTallTriangles) {
  const SurfaceMesh surface = shapes::cylinder(48, 2, 1, 6).weld();
  std::vector<Pin> pins;
  for (int k = 0; k <= 17; ++k) {
    const double turns = 3.0 * k / 17, angle = 2 * pi * turns;
    pins.push_back({{50 + 1100 * turns / 3, 50}, {std::cos(angle), std::sin(angle), 2.4 + 0.4 * turns}});
  }
  for (const Overlap overlap : {Overlap::stop, Overlap::allow}) {
    SolveOptions options;
    options.overlap = overlap;
    const auto map = solve_decal(surface, decal(surface, ribbon(), pins), options);
    ASSERT_TRUE(map.has_value()) << map.error().message;
    expect_exact_and_unfolded(*map);
    // Its ends, beyond the pins, meet the turns beside them.
    EXPECT_GT(map->quality.coverage, overlap == Overlap::allow ? 0.9999 : 0.9);
    EXPECT_LT(map->quality.coverage, 1.0001);
    EXPECT_LT(map->quality.l2_stretch, 1.001);
    EXPECT_GE(map->sheets, 3U);
  }
}

/// A ribbon laid round a circle on flat ground, whose ends lie on one another: in one sheet it would lie over
/// itself in the plane, and little of it could be shown.
TEST(Overlap, ARingThatClosesOverItselfIsShownWhole) {
  const SurfaceMesh surface = shapes::plane(40, 40, 6, 6, 0.2).weld();
  for (const double turns : {1.02, 1.05}) {
    std::vector<Pin> pins;
    for (int k = 0; k <= 6; ++k) {
      const double angle = 2 * pi * turns * k / 6;
      pins.push_back(
          {{50 + 1100.0 * k / 6, 50}, {3 + 1.2 * std::cos(angle), 3 + 1.2 * std::sin(angle), 0}, double(k)});
    }
    const auto map = solve_decal(surface, decal(surface, ribbon(), pins));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    expect_exact_and_unfolded(*map);
    EXPECT_GT(map->quality.coverage, 0.98);
    EXPECT_LT(map->quality.l2_stretch, 1.2);
    EXPECT_EQ(map->sheets, 2U);
  }
}

/// A pole of few triangles, round the z axis.
SurfaceMesh pole(int sides, int rows, double height, bool capped) {
  shapes::Soup soup = shapes::cylinder(sides, rows, 1, height);
  for (const double z : {0.0, height}) {
    if (!capped) break;
    const auto middle = static_cast<std::uint32_t>(soup.positions.size());
    soup.positions.push_back({0, 0, z});
    for (int i = 0; i < sides; ++i) {
      const std::uint32_t a = (z > 0 ? (sides + 1) * rows : 0) + i, b = a + 1;
      soup.triangles.push_back(z > 0 ? std::array{middle, a, b} : std::array{middle, b, a});
    }
  }
  return soup.weld();
}

/// A ribbon wound round a pole, pinned along its middle.
DecalInput helix(const SurfaceMesh& surface, double turns, int pins, double bottom, double rise) {
  std::vector<Pin> places;
  for (int k = 0; k <= pins; ++k) {
    const double angle = 2 * pi * turns * (k + 0.1) / pins;
    places.push_back({{50 + 1100.0 * k / pins, 50}, {std::cos(angle), std::sin(angle), bottom + rise * k}});
  }
  return decal(surface, ribbon(), places);
}

/// Turns that fall together on a pole of few triangles.
struct PoleCase {
  int sides, rows;
  double height;
  bool capped;
  double turns;
  int pins;
  double rise;
};

std::vector<PoleCase> pole_cases() {
  std::vector<PoleCase> cases;
  for (const int sides : {3, 4, 8, 12})
    for (const int rows : {1, 3})
      for (const double turns : {1.5, 2.5, 4.0})
        cases.push_back({sides, rows, 4, false, turns, static_cast<int>(4 * turns), 0});
  // The turns' paths run along the rims of caps, and meet over their middles.
  for (const int sides : {3, 8, 16}) cases.push_back({sides, 1, 6, true, 2.5, 16, 0.06});
  return cases;
}

/// Pins that are moved past each other bring turns over one another that are not: in groups the image would
/// fold.
TEST(Overlap, SwappedPinsOfARibbonFoldNothing) {
  const SurfaceMesh surface = shapes::cylinder(12, 6, 1, 4).weld();
  const std::array<double, 12> image = {50, 150, 250, 350, 450, 650, 950, 750, 850, 550, 1050, 1150};
  std::vector<Pin> places;
  for (int k = 0; k < 12; ++k) {
    const double angle = 9 * (k + 0.1) / 11;
    places.push_back({{image[k], 50}, {std::cos(angle), std::sin(angle), 1 + 0.2 * k}});
  }
  SolveOptions options;
  options.overlap = Overlap::allow;
  const auto map = solve_decal(surface, decal(surface, ribbon(), places), options);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->quality.flipped_plane + map->quality.flipped_image, 0u);
  EXPECT_GT(map->quality.coverage, 0.99);
  for (const double residual : map->quality.feature_residual) EXPECT_LT(residual, 0.01);
}

/// On the model's own triangles what cannot be met is said, never passed over.
TEST(Overlap, FeaturesOnPolesOfFewTrianglesAreMetOrNamed) {
  int met = 0, named = 0;
  for (const PoleCase& c : pole_cases()) {
    const SurfaceMesh surface = pole(c.sides, c.rows, c.height, c.capped);
    SolveOptions options;
    options.overlap = Overlap::allow;
    const auto map = solve_decal(surface, helix(surface, c.turns, c.pins, 2, c.rise), options);
    if (map) {
      for (const double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-6);
      EXPECT_EQ(map->divided, nullptr);
      ++met;
    } else {
      EXPECT_EQ(map.error().code, ErrorCode::not_solved);
      EXPECT_NE(map.error().message.find("divide"), std::string::npos) << map.error().message;
      ++named;
    }
  }
  EXPECT_GE(met, 16);
  EXPECT_GE(named, 1);
}

/// A pole unrolls: with triangles of their own the turns lie on it without stretch.
TEST(Overlap, DividedPolesCarryEveryTurn) {
  int divided = 0;
  for (const PoleCase& c : pole_cases()) {
    SCOPED_TRACE(testing::Message() << c.sides << " sides, " << c.rows << " rows, " << c.turns << " turns, "
                                    << (c.capped ? "capped" : "open"));
    const SurfaceMesh surface = pole(c.sides, c.rows, c.height, c.capped);
    SolveOptions options;
    options.overlap = Overlap::allow;
    options.divide = true;
    const auto map = solve_decal(surface, helix(surface, c.turns, c.pins, 2, c.rise), options);
    ASSERT_TRUE(map) << map.error().message;
    expect_exact_and_unfolded(*map);
    EXPECT_GT(map->quality.coverage, 0.9999);
    EXPECT_LT(map->quality.l2_stretch, 1.01);
    divided += map->divided != nullptr;
  }
  EXPECT_GE(divided, 9);
}

/// Turns that lie apart meet nowhere, whether or not the image may lie over itself; nor do few pins lead
/// astray.
TEST(Overlap, DividedPolesCarryTurnsThatLieApart) {
  for (const int sides : {3, 5, 8})
    for (const auto& [turns, pins] : {std::pair(3.0, 20), {1.0, 2}, {0.5, 4}, {1.0, 1}})
      for (const Overlap overlap : {Overlap::stop, Overlap::allow}) {
        SCOPED_TRACE(testing::Message() << sides << " sides, " << turns << " turns, " << pins << " pins");
        const SurfaceMesh surface = pole(sides, 1, 16, true);
        const double radius = std::cos(pi / sides);  // of the polygon within, whose sides the pins are on
        std::vector<Pin> places;
        for (int k = 0; k <= pins; ++k) {
          // Along the sides at even steps.
          const double along = sides * turns * (k + 0.03) / pins;
          const double side = std::floor(along), angle = 2 * pi * (side + 0.5) / sides;
          const double off = (along - side - 0.5) * 2 * std::sin(pi / sides);
          places.push_back({{50 + 1100.0 * k / pins, 50},
                            {radius * std::cos(angle) - off * std::sin(angle),
                             radius * std::sin(angle) + off * std::cos(angle), 4 + 2.5 * turns * k / pins}});
        }
        SolveOptions options;
        options.overlap = overlap;
        options.divide = true;
        const auto map = solve_decal(surface, decal(surface, ribbon(), places), options);
        ASSERT_TRUE(map) << map.error().message;
        expect_exact_and_unfolded(*map);
        EXPECT_GT(map->quality.coverage, 0.9999);
        EXPECT_LT(map->quality.l2_stretch, 1.01);
      }
}

/// Two corners of an image that are swapped ask for a mirrored part: finer triangles do not mend that.
TEST(Overlap, SwappedCornersOnAPoleAreNamed) {
  const SurfaceMesh surface = pole(4, 1, 6, true);
  SolveOptions options;
  options.divide = true;
  const Region card = *Region::from_contour({{0, 0}, {800, 0}, {800, 300}, {0, 300}}, {800, 300});
  const std::vector<Pin> pins = {{{160, 60}, {0.21, -0.79, 3.114}},
                                 {{640, 60}, {0.282, -0.718, 2.616}},
                                 {{640, 240}, {0.776, 0.224, 2.886}},
                                 {{160, 240}, {0.848, 0.152, 3.384}},
                                 {{400, 150}, {0.718, -0.282, 3}}};
  const auto map = solve_decal(surface, decal(surface, card, pins), options);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::features_mirrored);
  EXPECT_NE(map.error().message.find("features 0 to 4"), std::string::npos) << map.error().message;
}

/// How often the map shows the image at most, at points all over it; and at how many of them not at all.
std::pair<int, int> shown_at_points(const DecalMap& map, const Region& region) {
  int most = 0, bare = 0;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      const Vec2 z(-0.9913 + 0.0199 * i, -0.9907 + 0.0199 * j);
      if (!region.contains(z)) continue;
      int shown = 0;
      for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
        const auto& v = map.patch.faces[q].vertices;
        const Vec2 a = map.image[v[0]], b = map.image[v[1]], c = map.image[v[2]];
        shown +=
            map.textured[q] && cross(b - a, z - a) > 0 && cross(c - b, z - b) > 0 && cross(a - c, z - c) > 0;
      }
      most = std::max(most, shown);
      bare += shown == 0;
    }
  return {most, bare};
}

/// The walls of tunnels lie over one another, and over what is round their mouths, in any flat map.
TEST(Overlap, ADecalOverTunnelsIsShownOnce) {
  const SurfaceMesh surface = shapes::sponge(2, 2).weld();
  constexpr ImageFrame frame{256, 256};
  const Region square = *Region::from_contour({{8, 8}, {248, 8}, {248, 248}, {8, 248}}, frame);
  int clipped = 0;
  for (const Vec3& position : {Vec3(0.45, 0.45, 1), Vec3(0.05, 0.4, 1), Vec3(1, -0.6, 0.45)})
    for (const double size : {0.7, 1.2}) {
      DecalInput input{"test", square, {{{128, 128}, shapes::nearest(surface, position), 0}}, {}};
      input.lone = LoneFrame{size, Vec3(0, 1, 0)};
      const auto map = solve_decal(surface, input);
      ASSERT_TRUE(map.has_value()) << map.error().message;
      expect_exact_and_unfolded(*map);
      const auto [most, bare] = shown_at_points(*map, square);
      EXPECT_EQ(most, 1);
      EXPECT_NEAR(map->quality.coverage, 1 - bare / 8900.0, 0.02);
      EXPECT_GT(map->quality.coverage, 0.94);
      clipped += map->status == Coverage::clipped_in_plane;
    }
  EXPECT_GT(clipped, 2);
}

/// All of a closed surface but a face is flattened, however long it is.
TEST(Overlap, ADecalLargerThanALongClosedSurfaceTurnsNothingOver) {
  for (const double length : {1.0, 20.0, 60.0, 150.0}) {
    shapes::Soup soup = shapes::sphere(4, 1);
    for (Vec3& p : soup.positions) p.x() *= length;
    const SurfaceMesh surface = soup.weld();
    constexpr ImageFrame frame{256, 256};
    DecalInput input{"test",
                     *Region::from_contour({{8, 8}, {248, 8}, {248, 248}, {8, 248}}, frame),
                     {{{128, 128}, shapes::nearest(surface, {0.9 * length, 0, 1}), 0}},
                     {}};
    input.lone = LoneFrame{2.5 * length, Vec3(0, 1, 0)};
    const auto map = solve_decal(surface, input);
    ASSERT_TRUE(map.has_value()) << map.error().message;
    expect_exact_and_unfolded(*map);
  }
}

TEST(Overlap, StopsAtItselfUnlessAllowed) {
  const SurfaceMesh surface = shapes::cylinder(96, 40, 1, 4).weld();
  // Pinned on its first third only, the belt grows round and meets itself.
  std::vector<Pin> pins = belt(true);
  pins.resize(5);
  SolveOptions options;
  const auto stopped = solve_decal(surface, decal(surface, ribbon(), pins), options);
  ASSERT_TRUE(stopped.has_value()) << stopped.error().message;
  expect_exact_and_unfolded(*stopped);
  EXPECT_EQ(stopped->status, Coverage::clipped_by_cover);
  EXPECT_EQ(stopped->sheets, 1U);
  EXPECT_NEAR(stopped->quality.coverage, 2 * pi / (1200 / 1100.0 * 12 * pi / 4), 0.03);
  EXPECT_EQ(std::count_if(stopped->warnings.begin(), stopped->warnings.end(),
                          [](const Warning& w) {
                            return w.code == "clipped_by_cover" &&
                                   w.message.find("overlap") != std::string::npos;
                          }),
            1);
  options.overlap = Overlap::allow;
  const auto allowed = solve_decal(surface, decal(surface, ribbon(), pins), options);
  ASSERT_TRUE(allowed.has_value()) << allowed.error().message;
  expect_exact_and_unfolded(*allowed);
  EXPECT_EQ(allowed->status, Coverage::covered);
  EXPECT_EQ(allowed->sheets, 2U);
  EXPECT_GT(allowed->quality.coverage, 0.9999);
  EXPECT_LT(allowed->quality.l2_stretch, 1.001);
}

/// Nothing says which end of a band is to lie on top when one feature pins it: it is the same one everywhere.
TEST(Overlap, OneEndOfABandPinnedOnceLiesOnTopAsAWhole) {
  const SurfaceMesh torus = shapes::torus(128, 48, 1, 0.4).weld();
  for (const bool upright : {false, true}) {
    constexpr double length = 1300, width = 120;
    const ImageFrame frame = upright ? ImageFrame{width, length} : ImageFrame{length, width};
    const double w = frame.width, h = frame.height;
    DecalInput input{"test", *Region::from_contour({{0, 0}, {w, 0}, {w, h}, {0, h}}, frame), {}, {}};
    input.features.push_back({{w / 2, h / 2}, shapes::nearest(torus, {1.4, 0, 0}), 0});
    const double unit = 2 * pi * 1.4 / 1000;  // of a pixel
    input.lone = LoneFrame{w * unit, upright ? Vec3(0, 1, 0) : Vec3(0, 0, 1)};
    SolveOptions options;
    options.overlap = Overlap::allow;
    const auto map = solve_decal(torus, input, options);
    ASSERT_TRUE(map.has_value()) << map.error().message;
    expect_exact_and_unfolded(*map);
    const auto overlaps = stacks(*map);
    EXPECT_GT(overlaps.size(), 100U);
    for (const auto& stack : overlaps) {
      ASSERT_EQ(stack.size(), 2U);
      const Vec2 a = image_middle(*map, stack[0]), b = image_middle(*map, stack[1]);
      EXPECT_EQ(upright ? a.imag() < b.imag() : a.real() < b.real(),
                map->sheet[stack[0]] < map->sheet[stack[1]]);
    }
  }
}

/// A loop on the unit sphere that crosses itself near (0, 0, 1): the ends of the parameter [0, 1] stick out.
Vec3 loop(double t) {
  const double s = (2 * t - 1) * 1.25 * pi;  // from -225 to 225 degrees round a circle of radius 0.55
  const double along = 0.55 * std::sin(s), across = 0.55 * (1 + std::cos(s)) - 0.3;
  return Vec3(along, across, std::sqrt(1 - along * along - across * across));
}

/// A band of 1400 x 200 pixels over a closed surface, of `length` in all, pinned at its middle and at a
/// quarter of a turn of `radius` to either side.
DecalInput band(const SurfaceMesh& surface, double radius, const std::function<Vec3(double)>& around) {
  constexpr ImageFrame frame{1400, 200};
  Region region = *Region::from_contour({{0, 0}, {1400, 0}, {1400, 200}, {0, 200}}, frame);
  std::vector<Pin> pins;
  for (const double turn : {-0.25, -0.125, 0.0, 0.125, 0.25})
    pins.push_back({{700 + 1000 * turn, 100}, radius * around(2 * pi * turn)});
  return decal(surface, std::move(region), pins);
}

/// The band is 1.4 times as long as the way round.
struct ClosedCase {
  const char* name;
  SurfaceMesh surface;
  DecalInput input;
};

std::vector<ClosedCase> closed_cases() {
  std::vector<ClosedCase> cases;
  SurfaceMesh sphere = shapes::sphere(5, 1).weld(), torus = shapes::torus(128, 48, 1, 0.4).weld(),
              cylinder = shapes::cylinder(96, 60, 1, 4).weld();
  const auto equator = [](double a) { return Vec3(std::cos(a), std::sin(a), 0); };
  DecalInput on_sphere = band(sphere, 1, equator);
  DecalInput on_torus = band(torus, 1.4, equator);
  DecalInput on_cylinder = band(cylinder, 1, [](double a) { return Vec3(std::cos(a), std::sin(a), 2.02); });
  cases.push_back({"sphere", std::move(sphere), std::move(on_sphere)});
  cases.push_back({"torus", std::move(torus), std::move(on_torus)});
  cases.push_back({"cylinder", std::move(cylinder), std::move(on_cylinder)});
  return cases;
}

/// Faces along the middle of the band, all the way round, that show nothing of it.
std::size_t uncovered(const ClosedCase& shape, const DecalMap& map) {
  IdVector<FaceId, char> covered(shape.surface.faces.size(), 0);
  for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size()))
    if (map.textured[q]) covered[map.patch.faces[q].mesh_face] = 1;
  const Vec3 pinned = position_of(shape.surface, shape.input.features[2].surface);
  std::size_t count = 0;
  for (FaceId f : ids<FaceId>(shape.surface.faces.size())) {
    const auto c = shape.surface.corners(f);
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
    const bool along = std::abs(middle.z() - pinned.z()) < 0.15 &&
                       std::hypot(middle.x(), middle.y()) > 0.9 * std::hypot(pinned.x(), pinned.y());
    count += along && !covered[f];
  }
  return count;
}

TEST(Overlap, ABandThatMeetsItselfRoundAClosedSurfaceKeepsTheDisc) {
  for (const ClosedCase& shape : closed_cases()) {
    SCOPED_TRACE(shape.name);
    for (const Overlap overlap : {Overlap::stop, Overlap::allow}) {
      SCOPED_TRACE(overlap == Overlap::stop ? "stop" : "allow");
      SolveOptions options;
      options.overlap = overlap;
      options.check_patch = true;
      const auto map = solve_decal(shape.surface, shape.input, options);
      ASSERT_TRUE(map.has_value()) << map.error().message;
      expect_exact_and_unfolded(*map);
      if (overlap == Overlap::stop) {
        // One sheet, once round: nothing twice, and no gap at the seam.
        EXPECT_EQ(map->status, Coverage::clipped_by_cover);
        EXPECT_TRUE(stacks(*map).empty());
        EXPECT_NEAR(map->quality.coverage, 1 / 1.4, 0.01);
        EXPECT_EQ(uncovered(shape, *map), 0U);
      } else {
        EXPECT_EQ(map->status, Coverage::covered);
        EXPECT_FALSE(stacks(*map).empty());
        EXPECT_EQ(map->sheets, 2U);
        EXPECT_NEAR(map->quality.coverage, 1, 0.001);
      }
      EXPECT_LT(map->quality.l2_stretch, 1.02);
    }
  }
}

TEST(Overlap, ARibbonCrossesItselfOnASphere) {
  const SurfaceMesh surface = shapes::sphere(6, 1).weld();
  std::vector<Pin> pins;
  for (int k = 0; k <= 11; ++k) pins.push_back({{50 + 100.0 * k, 50}, loop(k / 11.0), k / 11.0});
  const auto map = solve_decal(surface, decal(surface, ribbon(), pins));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  expect_exact_and_unfolded(*map);
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_GT(map->quality.coverage, 0.999);
  EXPECT_LT(map->quality.coverage, 1.001);
  EXPECT_EQ(map->sheets, 2U);
  EXPECT_GT(map->groups, 1U);
  EXPECT_LT(map->quality.l2_stretch, 1.3);
  const auto overlaps = stacks(*map);
  EXPECT_GT(overlaps.size(), 20U);
  for (const auto& stack : overlaps) {
    const double x0 = image_middle(*map, stack[0]).real(), x1 = image_middle(*map, stack[1]).real();
    EXPECT_GT(std::abs(x1 - x0), 0.3);
    EXPECT_EQ(map->depth[stack[0]] < map->depth[stack[1]], x0 < x1);
  }
}

constexpr ImageFrame u_frame{600, 600};

/// A U whose arms are 100 px wide.
Region u_shape() {
  return *Region::from_contour(
      {{100, 50}, {200, 50}, {200, 450}, {400, 450}, {400, 50}, {500, 50}, {500, 550}, {100, 550}}, u_frame);
}

/// Its arms bent inwards until they cross; 1 scene unit is 100 px, y up.
std::vector<Pin> crossed_arms() {
  const auto at = [](double x, double y) { return Vec3(x / 100, (600 - y) / 100, 0); };
  return {{{150, 500}, at(150, 500), 0}, {{450, 500}, at(450, 500), 0}, {{150, 380}, at(170, 380), 0},
          {{450, 380}, at(430, 380), 0}, {{150, 240}, at(250, 260), 1}, {{450, 240}, at(350, 260), 2},
          {{150, 100}, at(360, 170), 1}, {{450, 100}, at(240, 170), 2}};
}

TEST(Overlap, TheArmsOfAUCrossWithoutAFoldAtEveryRefinement) {
  for (const int cells : thorough() ? std::vector{32, 48, 72, 96, 144} : std::vector{32, 72, 144}) {
    const SurfaceMesh surface = shapes::plane(cells, cells, 6, 6, 0.2).weld();
    const auto map = solve_decal(surface, decal(surface, u_shape(), crossed_arms()));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    expect_exact_and_unfolded(*map);
    EXPECT_GT(map->quality.coverage, 0.999);
    EXPECT_LT(map->quality.coverage, 1.001);
    EXPECT_EQ(map->sheets, 2U);
    EXPECT_GT(map->groups, 1U);
    RecordProperty("flips_" + std::to_string(cells), static_cast<int>(map->quality.flipped_image));
  }
}

}  // namespace
}  // namespace applique
