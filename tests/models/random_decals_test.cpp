// Random decals on a scanned head: nostrils, ears, lips, and a neck that ends.

#include "support/random_decals.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "applique/decal.h"

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

/// A strap of the helmet is a long closed surface, and the decal larger than it: of all of it but a face,
/// flattened, one end is smaller than the other by more than numbers tell apart.
TEST(RandomDecalsOnModels, ADecalLargerThanAStrapTurnsNothingOver) {
  const std::filesystem::path folder = APPLIQUE_TEST_DATA;
  if (folder.empty()) GTEST_SKIP() << "APPLIQUE_TEST_DATA does not name the folder of third-party models";
  const auto model = load_model(folder / "gltf/FlightHelmet/FlightHelmet.gltf");
  ASSERT_TRUE(model) << model.error().message;
  const ModelSurface surface = build_surface(*model, {}, {});
  const SurfacePoint place =
      SurfaceQuery(surface.mesh).nearest({0.12469748478497189, 0.572326815632406, 0.020244662802771155});
  std::vector<Pixel> disc;
  for (int k = 0; k < 62; ++k) disc.push_back({150 + 140 * std::cos(0.1 * k), 150 + 140 * std::sin(0.1 * k)});
  DecalInput input{"large", *Region::from_contour(disc, {300, 300}), {{{150, 150}, place, 0}}, {}};
  int solved = 0;
  for (const double size : {0.05, 0.1, 0.14, 0.177}) {
    input.lone = LoneFrame{size, Vec3(0, 1, 0.001)};
    const auto map = solve_decal(surface.mesh, input);
    if (!map) {
      EXPECT_EQ(map.error().code, ErrorCode::not_solved) << map.error().message;
      continue;
    }
    ++solved;
    EXPECT_EQ(map->quality.flipped_plane, 0U) << size;
    EXPECT_EQ(map->quality.flipped_image, 0U) << size;
  }
  EXPECT_GE(solved, 2);
}

}  // namespace
}  // namespace applique
