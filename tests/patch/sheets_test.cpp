#include "applique/patch/sheets.h"

#include <gtest/gtest.h>

namespace applique {
namespace {

TEST(Sheets, RanksByDepthThenByFace) {
  Patch patch;
  IdVector<PatchFaceId, double> depth;
  const auto add = [&](FaceId over, double at) {
    patch.faces.push_back({over, {}, {}});
    depth.push_back(at);
  };
  add(FaceId(7), 2);
  add(FaceId(3), 5);  // Alone.
  add(FaceId(7), -1);
  add(FaceId(), 1);  // Bridged holes are not over one another.
  add(FaceId(), 0);
  add(FaceId(7), 2);
  add(FaceId(4), 0);
  add(FaceId(4), 0);
  EXPECT_EQ(rank_sheets(patch, depth).raw(), (std::vector<std::uint32_t>{1, 0, 0, 0, 0, 2, 0, 1}));
}

TEST(Sheets, AnEmptyPatchHasNone) {
  EXPECT_TRUE(rank_sheets({}, {}).empty());
}

}  // namespace
}  // namespace applique
