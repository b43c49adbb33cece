// Other viewers show the decals where our preview shows them.

#include "viewers/agreement.h"

#include <gtest/gtest.h>

#include "gltf/test_models.h"

namespace applique {
namespace {

TEST(Viewers, ShowTheDecalsWhereOurPreviewDoes) {
  const ViewerTools tools = {APPLIQUE_COMMAND, APPLIQUE_ASSETS_COMMAND, APPLIQUE_NODE_MODULES, "chromium",
                             "blender",        APPLIQUE_VIEWER_SCRIPTS};
  if (const std::string missing = missing_tools(tools); !missing.empty())
    GTEST_SKIP() << "not installed: " << missing << " (./dev viewers installs them)";
  const TemporaryFolder folder;
  const auto decals = compare_viewers(tools, folder.path());
  ASSERT_TRUE(decals) << decals.error().message;
  ASSERT_EQ(decals->size(), 5u);
  for (const ViewedDecal& decal : *decals)
    for (const Agreement& agreement : {decal.with_three, decal.with_blender}) {
      EXPECT_GT(agreement.overlap, 0.95) << decal.name;
      EXPECT_GT(agreement.correlation, 0.9) << decal.name;
    }
}

}  // namespace
}  // namespace applique
