// A patch above the size from which Laplacians are solved by multigrid.

#include <algorithm>

#include <gtest/gtest.h>

#include "applique/base/laplacian_solver.h"
#include "applique/decal.h"
#include "applique/embed/boundary_first.h"

#include "support/hills_decal.h"
#include "support/shapes.h"

namespace applique {
namespace {

/// The whole surface as a disc.
DiscGeometry whole_disc(const SurfaceMesh& mesh) {
  BridgedSurface surface(mesh);
  ImmersedDisc disc(surface, FaceId(0));
  for (std::size_t i = 0; i < disc.faces().size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!disc.faces()[PatchFaceId(i)].neighbours[k].valid()) disc.glue(PatchFaceId(i), k, 1);
  disc.compact();
  return measure_disc(disc);
}

constexpr int cells = 260;  // 135 thousand triangles, most of them under the image

TEST(LargePatch, IsSolvedWithoutFoldsAndWithExactFeatures) {
  const SurfaceMesh surface = shapes::hills(cells).weld();
  const auto map = solve_decal(surface, hills_decal(surface));
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_GT(map->patch.vertices.size(), LaplacianSolverOptions().most_factored);
  EXPECT_EQ(map->status, Coverage::covered);
  EXPECT_EQ(map->quality.flipped_plane, 0u);
  EXPECT_EQ(map->quality.flipped_image, 0u);
  EXPECT_GT(map->quality.coverage, 0.9999);
  for (const double residual : map->quality.feature_residual) EXPECT_LT(residual, 1e-8);
  EXPECT_LT(map->quality.l2_stretch, 1.01);
}

/// In shares of the disc's size: nothing that a texture could show.
TEST(LargePatch, IsFlattenedAsByTheFactors) {
  const SurfaceMesh mesh = shapes::hills(cells).weld();
  const DiscGeometry disc = whole_disc(mesh);
  const std::vector<Vec2> iterated = flatten_boundary_first(disc);
  const std::vector<Vec2> exact = flatten_boundary_first(disc, {disc.vertices});
  ASSERT_NE(iterated, exact) << "both were factored";
  double apart = 0;
  for (std::size_t v = 0; v < exact.size(); ++v) apart = std::max(apart, std::abs(iterated[v] - exact[v]));
  EXPECT_LT(apart, 1e-8 * std::sqrt(disc.area));
}

}  // namespace
}  // namespace applique
