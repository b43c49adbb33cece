#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <regex>

#include <gtest/gtest.h>

#include "applique/decal.h"

#include "support/shapes.h"

namespace applique {
namespace {

/// The place of a tube of radius 1 that lies at `at` when it is unrolled.
SurfacePoint on_tube(const SurfaceMesh& tube, Vec2 at) {
  return shapes::nearest(tube, Vec3(std::cos(at.real()), std::sin(at.real()), 2 + at.imag()));
}

constexpr std::array<Pixel, 5> pins = {{{160, 60}, {640, 60}, {640, 240}, {160, 240}, {400, 150}}};

/// A card on the tube, turned, pinned at its corners and in its middle; pin k of the image lies where pin
/// order[k] should.
DecalInput card(const SurfaceMesh& tube, double turn, const std::array<std::size_t, 5>& order) {
  const Region region = *Region::from_contour({{0, 0}, {800, 0}, {800, 300}, {0, 300}}, ImageFrame{800, 300});
  DecalInput input{"card", region, {}, {}};
  for (std::size_t k = 0; k < pins.size(); ++k) {
    const Pixel place = pins[order[k]];
    const Vec2 at = std::polar(1.0, turn) * Vec2(place.x - 400, 150 - place.y) / 500.0;
    input.features.push_back({pins[k], on_tube(tube, at), 0});
  }
  return input;
}

std::uint32_t folds(const DecalMap& map) {
  return map.quality.flipped_plane + map.quality.flipped_image;
}

/// The features that warnings of this kind name.
std::vector<std::size_t> named(const DecalMap& map, const std::string& code) {
  std::vector<std::size_t> features;
  const std::regex feature("feature ([0-9]+) at");
  for (const Warning& warning : map.warnings) {
    if (warning.code != code) continue;
    for (std::sregex_iterator i(warning.message.begin(), warning.message.end(), feature), end; i != end; ++i)
      features.push_back(std::stoul((*i)[1]));
  }
  return features;
}

/// Corners in any order are met without a fold, or turned down as mirrored where all of the image would be.
TEST(FeaturesAtFault, CornersInAnyOrderFoldNothing) {
  const SurfaceMesh tube = shapes::cylinder(64, 40, 1, 4).weld();
  int mirrored = 0;
  std::array<std::size_t, 5> order = {0, 1, 2, 3, 4};
  do {
    for (const double turn : {0.3, 1.1, 2.0}) {
      const auto map = solve_decal(tube, card(tube, turn, order));
      if (map) {
        EXPECT_EQ(folds(*map), 0U);
        continue;
      }
      EXPECT_EQ(map.error().code, ErrorCode::features_mirrored) << map.error().message;
      EXPECT_EQ((std::array{order[1], order[2], order[3]}), (std::array<std::size_t, 3>{3, 2, 1}));
      ++mirrored;
    }
  } while (std::next_permutation(order.begin() + 1, order.begin() + 4));
  EXPECT_GE(mirrored, 2);
}

/// Pins that all but coincide on the surface and lie far apart in the image: where that folds it, features
/// are named without which it does not.
TEST(FeaturesAtFault, AreNamedAndWithoutThemNothingFolds) {
  const SurfaceMesh tube = shapes::cylinder(64, 40, 1, 4).weld();
  int folded = 0;
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random() % 1000) / 1000; };
    DecalInput input = card(tube, 0.3 * seed, {0, 1, 2, 3, 4});
    for (int k = 0; k < 3; ++k) {
      const double x = 300 + 200 * uniform(), y = 100 + 100 * uniform();
      const Vec2 at = Vec2(0.1, 0.1) + 0.001 * Vec2(uniform(), uniform());
      input.features.push_back({{x, y}, on_tube(tube, at), 0});
    }
    const auto map = solve_decal(tube, input);
    if (!map) {
      EXPECT_EQ(map.error().code, ErrorCode::not_solved) << map.error().message;
      EXPECT_NE(map.error().message.find("too near"), std::string::npos) << map.error().message;
      continue;
    }
    if (folds(*map) == 0) continue;
    ++folded;
    const std::vector<std::size_t> at_fault = named(*map, "features_fold");
    ASSERT_FALSE(at_fault.empty());
    ASSERT_LE(at_fault.size(), 3U);
    for (auto k = at_fault.rbegin(); k != at_fault.rend(); ++k)
      input.features.erase(input.features.begin() + static_cast<std::ptrdiff_t>(*k));
    const auto without = solve_decal(tube, input);
    ASSERT_TRUE(without) << without.error().message;
    EXPECT_EQ(folds(*without), 0U);
  }
  EXPECT_GE(folded, 3);
}

}  // namespace
}  // namespace applique
