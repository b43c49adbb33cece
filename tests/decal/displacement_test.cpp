#include <algorithm>
#include <numbers>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "applique/base/parallel.h"
#include "applique/decal.h"

#include "support/random_decals.h"
#include "support/shapes.h"
#include "support/thorough.h"

namespace applique {
namespace {

constexpr double size = 512;
constexpr ImageFrame frame{size, size};
constexpr double apart = 0.05;  // of the region's diameter, at least, between features in the image

struct Shape {
  std::string name;
  SurfaceMesh mesh;
  Vec3 near;  ///< The middle of the decals.
  double width;
};

std::vector<Shape> shapes_to_cover() {
  return {{"plane", shapes::plane(48, 48, 2, 2, 0.3).weld(), {1, 1, 0}, 1.3},
          {"cylinder", shapes::cylinder(96, 60, 1, 4).weld(), {1, 0, 2}, 2},
          {"sphere", shapes::sphere(5, 1).weld(), {0, 0, 1}, 1.4},
          {"torus", shapes::torus(96, 48, 1, 0.5).weld(), {1.5, 0, 0}, 1.2},
          {"bump", shapes::bump(64, 0.8, 0.3).weld(), {0.2, 0.1, 0.6}, 1.2}};
}

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A disc, a star or a bar.
Region random_region(std::mt19937& random) {
  const auto kind = random() % 3;
  std::vector<Pixel> contour;
  if (kind == 2) return *Region::from_contour({{20, 160}, {492, 160}, {492, 352}, {20, 352}}, frame);
  for (int k = 0; k < 40; ++k) {
    const double angle = 2 * std::numbers::pi * k / 40, radius = kind == 1 && k / 4 % 2 == 1 ? 130 : 240;
    contour.push_back({256 + radius * std::cos(angle), 256 + radius * std::sin(angle)});
  }
  return *Region::from_contour(contour, frame);
}

/// Where a solved map has a place of the image on the surface.
std::optional<SurfacePoint> locate(const DecalMap& map, Vec2 place) {
  for (const PatchFace& face : map.patch.faces) {
    if (!face.mesh_face.valid()) continue;
    std::array<Vec2, 3> z;
    for (int k = 0; k < 3; ++k) z[k] = map.image[face.vertices[k]];
    SurfacePoint point{face.mesh_face, {}};
    for (int k = 0; k < 3; ++k)
      point.barycentric[k] =
          cross(z[(k + 1) % 3] - place, z[(k + 2) % 3] - place) / cross(z[1] - z[0], z[2] - z[0]);
    if (std::all_of(point.barycentric.begin(), point.barycentric.end(), [](double b) { return b > 1e-3; }))
      return point;
  }
  return std::nullopt;
}

/// Whether the places lie in the region and apart.
bool fits(const Region& region, const std::vector<Vec2>& places) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!region.contains(places[i])) return false;
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(places[i] - places[j]) < apart * region.diameter()) return false;
  }
  return true;
}

/// Each place moved by up to 30 % of the region, or some of them turned about their middle by up to 170
/// degrees.
std::vector<Vec2> displaced(const Region& region, const std::vector<Vec2>& places, std::mt19937& random,
                            double share) {
  for (int tries = 0; tries < 1000; ++tries) {
    std::vector<Vec2> moved = places;
    if (random() % 2 == 0) {
      const double reach = share * uniform(random, 0, 0.3) * region.diameter();
      for (Vec2& z : moved) z += std::polar(reach * std::sqrt(uniform(random, 0, 1)), uniform(random, -4, 4));
    } else {
      const std::size_t count = 2 + random() % (moved.size() - 1);
      Vec2 middle = 0;
      for (std::size_t k = 0; k < count; ++k) middle += moved[k] / double(count);
      const Vec2 turn = std::polar(1.0, share * uniform(random, -170, 170) * std::numbers::pi / 180);
      for (std::size_t k = 0; k < count; ++k) moved[k] = middle + turn * (moved[k] - middle);
    }
    if (fits(region, moved)) return moved;
  }
  return places;
}

/// A decal whose features lie where an undistorted image would have them, then displaced in the image; by
/// `share` of as far as any.
DecalInput displaced_decal(const Shape& shape, std::uint32_t seed, double share = 1) {
  std::mt19937 random(seed);
  DecalInput input{"displaced", random_region(random), {}, {}};
  const SurfacePoint middle = shapes::nearest(shape.mesh, shape.near);
  const double turn = uniform(random, -4, 4);
  input.lone = LoneFrame{shape.width, Vec3(std::cos(turn), std::sin(turn), 0.3)};
  input.features.push_back({{256, 256}, middle, 0});
  const auto map = solve_decal(shape.mesh, input);
  EXPECT_TRUE(map.has_value()) << map.error().message;
  input.features.clear();

  const auto count = 2 + random() % 8;
  std::vector<Vec2> places;
  for (int tries = 0; tries < 1000 && places.size() < count; ++tries) {
    const Vec2 place = frame.to_plane({uniform(random, 0, size), uniform(random, 0, size)});
    places.push_back(place);
    const auto point = fits(input.region, places) ? locate(*map, place) : std::nullopt;
    if (point)
      input.features.push_back({{0, 0}, *point, 0});
    else
      places.pop_back();
  }
  places = displaced(input.region, places, random, share);
  for (std::size_t k = 0; k < places.size(); ++k) input.features[k].image = frame.to_pixel(places[k]);
  return input;
}

TEST(Displacements, AreMetExactlyAndTurnNothingOver) {
  random_decals::Tally tally;
  const int count = thorough() ? 200 : 20;  // on each surface
  for (const Shape& shape : shapes_to_cover()) {
    std::vector<std::string> outcomes(count);
    parallel_for(count, [&](int i) {
      const DecalInput input = displaced_decal(shape, static_cast<std::uint32_t>(i));
      outcomes[i] = random_decals::outcome(solve_decal(shape.mesh, input));
    });
    for (int i = 0; i < count; ++i) {
      EXPECT_NE(outcomes[i], "") << shape.name << " " << i;
      tally.add(shape.name, outcomes[i]);
    }
  }
  tally.print("displaced");
  EXPECT_GT(tally.share_solved(), 0.98);
}

/// How far the warp moves the features, root of the mean square.
double left_to_the_warp(const DecalInput& input, const DecalMap& map) {
  double sum = 0;
  for (const Feature& feature : input.features)
    for (const PatchFace& face : map.patch.faces) {
      if (face.mesh_face != feature.surface.face) continue;
      Vec2 place = 0;
      for (int k = 0; k < 3; ++k) place += feature.surface.barycentric[k] * map.plane[face.vertices[k]];
      sum += std::norm(map.warp(place, map.influence_at(face.vertices, feature.surface.barycentric)) - place);
    }
  return std::sqrt(sum / static_cast<double>(input.features.size()));
}

/// Of little displacements; large ones are left to the warp.
TEST(Displacements, AreLessWorkForTheWarpWithAGuide) {
  for (const Shape& shape : shapes_to_cover()) {
    constexpr int count = 48;  // Fewer hang on the few that ask too much to be guided.
    std::vector<std::array<double, 2>> work(count), stretch(count);
    parallel_for(count, [&](int i) {
      const DecalInput input = displaced_decal(shape, static_cast<std::uint32_t>(i), 0.07);
      for (const bool guide : {false, true}) {
        SolveOptions options;
        options.guide = guide;
        const auto map = solve_decal(shape.mesh, input, options);
        EXPECT_EQ(random_decals::outcome(map), "solved") << shape.name << " " << i;
        if (!map) continue;
        work[i][guide] = left_to_the_warp(input, *map);
        stretch[i][guide] = map->quality.l2_stretch;
      }
    });
    double with = 0, without = 0, by_stretch = 0;
    for (int i = 0; i < count; ++i) {
      without += work[i][0], with += work[i][1];
      by_stretch += std::log(stretch[i][1] / stretch[i][0]) / count;
    }
    EXPECT_LT(with, 0.7 * without) << shape.name;
    EXPECT_LT(by_stretch, 0) << shape.name;
    std::printf("%s: a guide leaves %.2f of the shifts and %.3f times the L2 stretch\n", shape.name.c_str(),
                with / without, std::exp(by_stretch));
  }
}

}  // namespace
}  // namespace applique
