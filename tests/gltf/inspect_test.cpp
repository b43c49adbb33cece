#include "inspect.h"

#include <gtest/gtest.h>

#include "gltf/test_models.h"
#include "uv_coverage.h"

namespace applique {
namespace {

ModelSummary inspect(const std::string& name) {
  const auto model = load_model(test_data() / name);
  EXPECT_TRUE(model) << name;
  return model ? inspect_model(*model) : ModelSummary();
}

TEST(UvCoverage, CountsEachTexelOfATilingOnce) {
  // The unit square cut into a fan around an odd point: no gap, no texel twice.
  UvCoverage coverage(64, WrapMode::repeat, WrapMode::repeat);
  const std::array<double, 2> centre = {0.3712, 0.6133};
  const std::array<std::array<double, 2>, 4> corners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t k = 0; k < 4; ++k) coverage.add({centre, corners[k], corners[(k + 1) % 4]});
  EXPECT_EQ(coverage.covered(), 1);
  EXPECT_EQ(coverage.shared(), 0);
}

TEST(UvCoverage, WrapsAsTheSamplerDoes) {
  // The left half of the texture, seen through each mode from x in [1, 1.5].
  const std::array<std::array<std::array<double, 2>, 3>, 2> half = {
      {{{{1, 0}, {1.5, 0}, {1.5, 1}}}, {{{1, 0}, {1.5, 1}, {1, 1}}}}};
  for (const auto& [mode, covered] :
       {std::pair{WrapMode::repeat, 0.5}, {WrapMode::mirror, 0.5}, {WrapMode::clamp, 1.0 / 64}}) {
    UvCoverage coverage(64, mode, WrapMode::repeat);
    for (const auto& triangle : half) coverage.add(triangle);
    EXPECT_EQ(coverage.covered(), covered);
    EXPECT_EQ(coverage.shared(), mode == WrapMode::clamp ? 1 : 0);
  }
}

TEST(InspectModel, AgreesWithWhatIsKnownOfTheModels) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const ModelSummary duck = inspect("gltf/Duck.glb");
  EXPECT_EQ(duck.triangles, 4212u);
  EXPECT_EQ(duck.boundary_edges, 0u);
  ASSERT_EQ(duck.materials.size(), 1u);
  EXPECT_NEAR(duck.materials[0].shared_texels, 0.94, 0.01) << "its two sides share the texture";
  EXPECT_NEAR(duck.materials[0].mirrored, 0.49, 0.01);
  EXPECT_EQ(duck.materials[0].texture_size, (std::array<int, 2>{512, 512}));

  const ModelSummary bottle = inspect("gltf/WaterBottle/WaterBottle.gltf");
  EXPECT_EQ(bottle.boundary_edges, 264u);
  EXPECT_LT(bottle.materials[0].shared_texels, 0.005);
  EXPECT_EQ(bottle.materials[0].texture_size, (std::array<int, 2>{2048, 2048}));
  EXPECT_GT(bottle.materials[0].texel_density, 1000) << "2048 texels around a bottle of some 0.3 m";

  const ModelSummary man = inspect("gltf/CesiumMan.glb");
  EXPECT_EQ(man.skins, 1u);
  EXPECT_EQ(man.animations, 1u);

  const ModelSummary morph = inspect("gltf/MorphStressTest.gltf");
  EXPECT_EQ(morph.morph_targets, 8u);
  EXPECT_EQ(morph.materials.size(), 2u);
  EXPECT_EQ(morph.materials[0].uv_sets, (std::vector<std::string>{"TEXCOORD_0", "TEXCOORD_1"}));

  const ModelSummary cubes = inspect("gltf/many-cubes/many-cubes.gltf");
  EXPECT_EQ(cubes.components, 501u);
  ASSERT_EQ(cubes.materials.size(), 1u);
  EXPECT_FALSE(cubes.materials[0].material.has_value());
  EXPECT_EQ(cubes.materials[0].triangles_without_uvs, cubes.triangles);
}

TEST(InspectModel, TilesAreSharedTexels) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const ModelSummary cloth = inspect("gltf/SheenCloth.glb");
  EXPECT_EQ(cloth.materials[0].shared_texels, 1);
  EXPECT_NEAR(cloth.materials[0].uv_upper[0] - cloth.materials[0].uv_lower[0], 30, 1);
}

TEST(InspectModel, IsWrittenAsJson) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const auto json = to_json(inspect("gltf/CesiumMilkTruck.glb"));
  EXPECT_EQ(json["parts"].size(), 5u);
  EXPECT_EQ(json["materials"].size(), 4u);
  EXPECT_EQ(json["surface"]["non_manifold_edges"], 0);
  std::size_t triangles = 0;
  for (const auto& material : json["materials"]) triangles += material["triangles"].get<std::size_t>();
  EXPECT_EQ(json["triangles"], triangles);
}

}  // namespace
}  // namespace applique
