#include "applique/suggest.h"

#include <cmath>

#include <gtest/gtest.h>

#include "applique/surface/surface_query.h"

#include "support/shapes.h"

namespace applique {
namespace {

constexpr ImageFrame frame{512, 512};

/// Five pins on [1, 3] x [1, 3] x {0}, where the whole image lies; the one in the middle moved aside.
DecalInput five_pins(const SurfaceMesh& surface, double aside) {
  DecalInput input = {"test", *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, frame), {}, {}};
  for (const Pixel px : {Pixel{128, 128}, {384, 128}, {384, 384}, {128, 384}, {256, 256}})
    input.features.push_back({px, shapes::nearest(surface, {1 + px.x / 256, 3 - px.y / 256, 0})});
  input.features.back().surface = shapes::nearest(surface, {2 + aside, 2, 0});
  return input;
}

TEST(Suggest, NothingWhereAllIsAtEase) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.2).weld();
  const DecalInput input = five_pins(surface, 0);
  const DecalMap map = *solve_decal(surface, input);
  const Suggestion suggestion = suggest_feature(surface, input, map);
  EXPECT_NEAR(suggestion.l2_stretch, 1, 1e-9);
  EXPECT_FALSE(suggestion.add);
  EXPECT_FALSE(suggestion.leave_out);
}

TEST(Suggest, LeavesOutTheFeatureThatIsMisplaced) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.2).weld();
  const DecalInput input = five_pins(surface, 0.15);
  const DecalMap map = *solve_decal(surface, input);
  const Suggestion suggestion = suggest_feature(surface, input, map);
  EXPECT_EQ(suggestion.l2_stretch, map.quality.l2_stretch);
  ASSERT_TRUE(suggestion.leave_out);
  EXPECT_EQ(suggestion.leave_out->feature, 4u);
  EXPECT_NEAR(suggestion.leave_out->l2_stretch, 1, 1e-6) << "the others are at ease";
}

/// What is promised is what a solution with the feature gives; the pin at the present correspondence gives
/// next to nothing. (With a guide the map is already where a further feature would draw it.)
TEST(Suggest, AFurtherFeatureTakesStretchOff) {
  const SurfaceMesh surface = shapes::plane(40, 40, 4, 4, 0.2).weld();
  const DecalInput input = five_pins(surface, 0.15);
  SuggestOptions options;
  options.solve.guide = false;
  const DecalMap map = *solve_decal(surface, input, options.solve);
  const Suggestion suggestion = suggest_feature(surface, input, map, options);
  ASSERT_TRUE(suggestion.add);
  EXPECT_LT(suggestion.add->l2_stretch, 0.999 * suggestion.l2_stretch);
  DecalInput changed = input;
  changed.features.push_back(suggestion.add->feature);
  const auto solved = solve_decal(surface, changed, options.solve);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_DOUBLE_EQ(solved->quality.l2_stretch, suggestion.add->l2_stretch);
  EXPECT_EQ(solved->quality.flipped_image, 0u);
  EXPECT_GT(solved->quality.coverage, 0.99);
  const DecalMap guided = *solve_decal(surface, input);
  EXPECT_LT(guided.quality.l2_stretch, 1.001 * suggestion.add->l2_stretch);
}

/// Where a decal is all but torn, the map jumps with the last digit of a place: a promise is of the feature
/// as it is read back, from tenths of a pixel and the nearest surface point to six digits. Here a lone
/// feature lays an image all round a ball.
TEST(Suggest, KeepsItsWordWhereTheMapHangsByAThread) {
  const SurfaceMesh surface = shapes::sphere(2, 1).weld();
  DecalInput input = {"test", *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, frame), {}, {}};
  input.features.push_back({{256, 256}, shapes::nearest(surface, {0, 0.1, 1})});
  input.lone = LoneFrame{5, {0, 1, 0}};
  const DecalMap map = *solve_decal(surface, input);
  const Suggestion suggestion = suggest_feature(surface, input, map);
  ASSERT_TRUE(suggestion.add);
  const Suggestion::Added& added = *suggestion.add;
  EXPECT_EQ(added.feature.image.x, std::round(10 * added.feature.image.x) / 10);
  EXPECT_EQ(added.feature.image.y, std::round(10 * added.feature.image.y) / 10);
  EXPECT_EQ(position_of(surface, SurfaceQuery(surface).nearest(added.position)),
            position_of(surface, added.feature.surface));
  DecalInput changed = input;
  changed.features.push_back({added.feature.image, SurfaceQuery(surface).nearest(added.position), 0});
  EXPECT_EQ(solve_decal(surface, changed)->quality.l2_stretch, added.l2_stretch);
}

/// Other methods have no warp to relax, but may have a feature too many.
TEST(Suggest, OfThePapersMethodLooksForOneTooManyOnly) {
  const SurfaceMesh surface = shapes::plane(32, 32, 4, 4).weld();
  DecalInput input = five_pins(surface, 0.15);
  SuggestOptions options;
  options.solve.method = Method::paper;
  const auto map = solve_decal(surface, input, options.solve);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_TRUE(map->stress.features.empty());
  const Suggestion suggestion = suggest_feature(surface, input, *map, options);
  EXPECT_FALSE(suggestion.add);
  ASSERT_TRUE(suggestion.leave_out);
  EXPECT_EQ(suggestion.leave_out->feature, 4u);
}

}  // namespace
}  // namespace applique
