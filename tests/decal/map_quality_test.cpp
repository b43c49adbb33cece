#include "applique/quality/map_quality.h"

#include <array>

#include <gtest/gtest.h>

#include "applique/image/image.h"

#include "support/shapes.h"

namespace applique {
namespace {

/// Two groups of two features each, far away and equally far: the first rests, the second moves by `shift`.
Warp resting_and_moving(Vec2 shift) {
  Warp warp;
  warp.steps = 1;
  warp.features = 4;
  warp.groups = 2;
  warp.group = {0, 0, 1, 1};
  warp.pairs = {{0, 1}, {2, 3}};
  for (const double t : {0.0, 0.5, 1.0}) {
    const std::array<Vec2, 4> at = {Vec2(-1000, 0), Vec2(1000, 0), Vec2(0, -1000) + t * shift,
                                    Vec2(0, 1000) + t * shift};
    warp.position.insert(warp.position.end(), at.begin(), at.end());
    warp.lambda.insert(warp.lambda.end(), {0, 0});
    warp.offset.insert(warp.offset.end(), {0, shift});
  }
  return warp;
}

TEST(MapQuality, AWarpMayTurnOverByItsInfluenceAlone) {
  const ImageFrame frame{512, 512};
  const Region region = Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, frame).value();
  const SurfaceMesh surface = shapes::plane(1, 1, 1, 1).weld();
  Patch patch;
  for (const VertexId v : surface.faces[FaceId(0)]) patch.vertices.push_back(v);
  patch.faces.push_back({FaceId(0), {PatchVertexId(0), PatchVertexId(1), PatchVertexId(2)}, {}});
  const IdVector<PatchVertexId, Vec2> plane(std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}});
  const IdVector<PatchVertexId, Vec2> turned(std::vector<Vec2>{{0, 0}, {-1, 0}, {0, 1}});
  const IdVector<PatchFaceId, char> textured(1, 1);
  const auto flips = [&](const Warp& warp, const std::vector<double>& influence) {
    return measure_quality(surface, patch, plane, turned, textured, warp, region, influence).flipped_image;
  };
  const Warp warp = resting_and_moving({-2, 0});
  EXPECT_EQ(flips(warp, {1, 0, 0, 1, 1, 0}), 1U);  // The second corner is carried past the first.
  EXPECT_EQ(flips(warp, {1, 0, 1, 0, 1, 0}), 0U);  // Everything rests: only interpolation turns over.
  EXPECT_EQ(flips(warp, {0, 1, 0, 1, 0, 1}), 0U);  // Everything moves.
}

TEST(MapQuality, AreaIsExactInTrianglesOfAnySize) {
  const Region region =
      Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {256, 300}, {0, 512}}, ImageFrame{512, 512})
          .value();
  for (const double size : {2.0, 1e3, 1e6, 1e9, 1e12}) {
    // The two sides of a line through the region.
    const Vec2 a = size * Vec2(-1, -0.7), b = size * Vec2(1, 0.7);
    const double area = area_in_region(region, {a, b, size * Vec2(-2, 2)}) +
                        area_in_region(region, {b, a, size * Vec2(2, -2)});
    EXPECT_NEAR(area, region.area(), 1e-4 * region.area()) << size;
  }
}

/// Two right triangles that make up the unit square, or lie over one another, in the plane and in the image.
MapQuality quality_of_two(const std::vector<Vec2>& plane, const std::vector<Vec2>& image) {
  const Region region =
      Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, ImageFrame{512, 512}).value();
  const SurfaceMesh surface = shapes::plane(1, 1, 1, 1).weld();
  Patch patch;
  for (const FaceId f : ids<FaceId>(surface.faces.size())) {
    const auto first = static_cast<std::uint32_t>(patch.vertices.size());
    for (const VertexId v : surface.faces[f]) patch.vertices.push_back(v);
    patch.faces.push_back(
        {f, {PatchVertexId(first), PatchVertexId(first + 1), PatchVertexId(first + 2)}, {}});
  }
  Warp rests;
  rests.steps = 1;
  rests.features = 2;
  rests.groups = 1;
  rests.group = {0, 0};
  rests.pairs = {{0, 1}};
  for (int t = 0; t < 3; ++t) {
    rests.position.insert(rests.position.end(), {Vec2(-1000, 0), Vec2(1000, 0)});
    rests.lambda.push_back(0);
    rests.offset.push_back(0);
  }
  return measure_quality(surface, patch, IdVector<PatchVertexId, Vec2>(plane),
                         IdVector<PatchVertexId, Vec2>(image), IdVector<PatchFaceId, char>(2, 1), rests,
                         region);
}

/// A warp may bend triangles so much that their corners enclose what others do; in the plane, where they are
/// what they are, it shows whether they lie over one another.
TEST(MapQuality, TellsWhatIsShownTwiceFromWhatIsBent) {
  const std::vector<Vec2> beside = {{-0.6, -0.6}, {0.6, -0.6}, {-0.6, 0.6},
                                    {0.6, -0.6},  {0.6, 0.6},  {-0.6, 0.6}};
  const std::vector<Vec2> over = {{-0.6, -0.6}, {0.6, -0.6}, {-0.6, 0.6},
                                  {-0.6, -0.6}, {0.6, -0.6}, {-0.6, 0.6}};
  const std::vector<Vec2> large = {{-1, -1}, {1, -1}, {-1, 1}, {1, -1}, {1, 1}, {-1, 1}};
  const std::vector<Vec2> bent = {{-1, -1}, {1, -1}, {-1, 3}, {1, -3}, {1, 1}, {-1, 1}};
  const MapQuality square = quality_of_two(large, large);
  EXPECT_NEAR(square.coverage, 1, 1e-12);
  EXPECT_NEAR(square.doubled, 0, 1e-12);
  const MapQuality bends = quality_of_two(beside, bent);
  EXPECT_EQ(bends.doubled, 0);
  EXPECT_EQ(bends.coverage, 1);
  const MapQuality twice = quality_of_two(over, bent);
  EXPECT_EQ(twice.doubled, 1);
  EXPECT_GT(twice.coverage, 1.4);
}

}  // namespace
}  // namespace applique
