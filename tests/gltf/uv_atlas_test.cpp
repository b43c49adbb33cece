#include "uv_atlas.h"

#include <bit>
#include <random>

#include <gtest/gtest.h>

namespace applique {
namespace {

bool apart(const AtlasBox& a, const AtlasBox& b) {
  return a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
}

TEST(PackAtlas, PutsBoxesSideBySide) {
  std::mt19937 random(7);
  for (const int fineness : {1, 3, 7}) {
    for (const int count : {1, 2, 17, 200}) {
      std::vector<AtlasBox> boxes(static_cast<std::size_t>(count));
      for (AtlasBox& box : boxes) {
        box.width = std::uniform_int_distribution(1, 40)(random);
        box.height = std::uniform_int_distribution(1, 40)(random);
      }
      const auto size = pack_atlas(boxes, fineness, 8192);
      ASSERT_TRUE(size);
      std::int64_t area = 0;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        EXPECT_GE(boxes[i].x, 0);
        EXPECT_GE(boxes[i].y, 0);
        EXPECT_LE(fineness * (boxes[i].x + boxes[i].width), (*size)[0]);
        EXPECT_LE(fineness * (boxes[i].y + boxes[i].height), (*size)[1]);
        area += std::int64_t{fineness} * fineness * boxes[i].width * boxes[i].height;
        for (std::size_t j = 0; j < i; ++j) EXPECT_TRUE(apart(boxes[i], boxes[j])) << i << ", " << j;
      }
      for (const int side : *size) EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(side))) << side;
      if (count == 200) {
        EXPECT_LT(std::int64_t{(*size)[0]} * (*size)[1], 5 * area)
            << "powers of two double the area at most twice";
      }
    }
  }
}

TEST(PackAtlas, FillsRowsWithoutAGap) {
  std::vector<AtlasBox> boxes(16, AtlasBox{64, 64, 0, 0});
  EXPECT_EQ(pack_atlas(boxes, 1, 8192), (std::array<int, 2>{256, 256}));
}

TEST(PackAtlas, TellsWhatDoesNotFit) {
  std::vector<AtlasBox> boxes(17, AtlasBox{64, 64, 0, 0});
  EXPECT_FALSE(pack_atlas(boxes, 1, 256));
  boxes = {{300, 10, 0, 0}};
  EXPECT_FALSE(pack_atlas(boxes, 1, 256));
  boxes = {{100, 10, 0, 0}};
  EXPECT_FALSE(pack_atlas(boxes, 3, 256));
}

}  // namespace
}  // namespace applique
