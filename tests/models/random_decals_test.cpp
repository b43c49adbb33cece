// Random decals on a scanned head: nostrils, ears, lips, and a neck that ends.

#include "support/random_decals.h"

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "model.h"

namespace applique {
namespace {

TEST(RandomDecalsOnModels, AreSolvedOrTurnedDownWithAReason) {
  const std::filesystem::path folder = APPLIQUE_TEST_DATA;
  if (folder.empty()) GTEST_SKIP() << "APPLIQUE_TEST_DATA does not name the folder of third-party models";
  const auto model = load_model(folder / "gltf/LeePerrySmith/LeePerrySmith.glb");
  ASSERT_TRUE(model) << model.error().message;
  const ModelSurface surface = build_surface(*model, {}, {});
  const SurfaceQuery query(surface.mesh);
  const random_decals::Ground ground{"LeePerrySmith", &surface.mesh, &query, 0.15 * model->diagonal()};
  setenv("RC_PARAMS", "seed=20261124 max_success=100", 0);
  random_decals::Tally tally;
  EXPECT_TRUE(rc::check("random decals on a head", [&] {
    std::mt19937 random(random_decals::any_seed());
    const DecalInput input = random_decals::random_decal(ground, random);
    SolveOptions options;
    options.check_patch = true;
    const std::string outcome = random_decals::outcome(solve_decal(surface.mesh, input, options));
    tally.add(ground.name, outcome);
    RC_ASSERT(!outcome.empty());
  }));
  tally.print("applique");
  EXPECT_GT(tally.share_solved(), 0.95);
}

}  // namespace
}  // namespace applique
