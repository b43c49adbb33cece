#include "applique/patch/sheets.h"

#include <gtest/gtest.h>

namespace applique {
namespace {

TEST(Sheets, RanksByDepthThenByOrderThenByFace) {
  Patch patch;
  FaceDepths depths;
  const auto add = [&](FaceId over, double depth, double order = 0) {
    patch.faces.push_back({over, {}, {}});
    depths.depth.push_back(depth);
    depths.order.push_back(order);
  };
  add(FaceId(7), 2);
  add(FaceId(3), 5);  // Alone.
  add(FaceId(7), -1);
  add(FaceId(), 1);  // Bridged holes are not over one another.
  add(FaceId(), 0);
  add(FaceId(7), 2);
  add(FaceId(4), 0);
  add(FaceId(4), 0);
  add(FaceId(5), 0, 2);
  add(FaceId(5), 0, 1);
  EXPECT_EQ(rank_sheets(patch, depths).raw(), (std::vector<std::uint32_t>{1, 0, 0, 0, 0, 2, 0, 1, 1, 0}));
}

TEST(Sheets, AnEmptyPatchHasNone) {
  EXPECT_TRUE(rank_sheets({}, {}).empty());
}

}  // namespace
}  // namespace applique
