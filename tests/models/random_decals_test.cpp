// Random decals on a scanned head: nostrils, ears, lips, and a neck that ends.

#include "support/random_decals.h"

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "model.h"
#include "support/thorough.h"

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
  setenv("RC_PARAMS", thorough() ? "seed=20261124 max_success=100" : "seed=20261124 max_success=50", 0);
  random_decals::Tally tally;
  EXPECT_TRUE(random_decals::check(ground, tally));
  tally.print("applique");
  EXPECT_GT(tally.share_solved(), 0.95);
}

}  // namespace
}  // namespace applique
