#include "applique/patch/immersed_disc.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "applique/patch/seed.h"

#include "support/shapes.h"

namespace applique {
namespace {

struct Shape {
  const char* name;
  shapes::Soup soup;
};

std::vector<Shape> all_shapes() {
  return {{"icosahedron", shapes::sphere(0, 1)},      {"sphere", shapes::sphere(2, 1)},
          {"torus", shapes::torus(12, 8, 2, 0.8)},    {"tiny torus", shapes::torus(4, 4, 2, 0.8)},
          {"cylinder", shapes::cylinder(9, 5, 1, 2)}, {"plane", shapes::plane(6, 6, 1, 1)}};
}

/// Random glue and peel, at random cover limits: the disc stays a disc whatever happens.
TEST(ImmersedDisc, StaysADiscUnderRandomOperations) {
  for (const Shape& shape : all_shapes()) {
    const SurfaceMesh mesh = shape.soup.weld();
    std::mt19937 random(7);
    for (int run = 0; run < 12; ++run) {
      BridgedSurface surface(mesh);
      ImmersedDisc disc(surface, FaceId(random() % mesh.faces.size()));
      const std::uint32_t cover_limit = 1 + static_cast<std::uint32_t>(run % 3);
      for (int step = 0; step < 600; ++step) {
        const PatchFaceId q(random() % disc.faces().size());
        if (!disc.alive(q)) continue;
        const int k = static_cast<int>(random() % 3);
        if (random() % 4 != 0) {
          if (!disc.faces()[q].neighbours[k].valid()) disc.glue(q, k, cover_limit);
        } else if (disc.removable(q)) {
          disc.remove(q);
        }
        if (step % 20 == 0) {
          ASSERT_EQ(disc.broken_invariant(), "") << shape.name << ", step " << step;
        }
        if (step % 200 == 199) disc.compact();
      }
      ASSERT_EQ(disc.broken_invariant(), "") << shape.name;
      for (FaceId f : ids<FaceId>(mesh.faces.size())) ASSERT_LE(disc.cover(f), cover_limit);
    }
  }
}

TEST(ImmersedDisc, CoversAWholePlaneOnce) {
  const SurfaceMesh mesh = shapes::plane(8, 8, 1, 1).weld();
  BridgedSurface surface(mesh);
  ImmersedDisc disc(surface, FaceId(40));
  for (std::size_t i = 0; i < disc.faces().size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!disc.faces()[PatchFaceId(i)].neighbours[k].valid()) disc.glue(PatchFaceId(i), k, 1);
  EXPECT_EQ(disc.broken_invariant(), "");
  EXPECT_EQ(disc.live_faces(), mesh.faces.size());
  EXPECT_EQ(disc.boundary_length(), 32u);  // no slits are left
}

TEST(ImmersedDisc, FrontsThatMeetRoundACylinderStayApart) {
  const SurfaceMesh mesh = shapes::cylinder(12, 4, 1, 2).weld();
  BridgedSurface surface(mesh);
  ImmersedDisc disc(surface, FaceId(0));
  for (std::size_t i = 0; i < disc.faces().size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!disc.faces()[PatchFaceId(i)].neighbours[k].valid()) disc.glue(PatchFaceId(i), k, 1);
  EXPECT_EQ(disc.broken_invariant(), "");
  EXPECT_EQ(disc.live_faces(), mesh.faces.size());
  EXPECT_GT(disc.boundary_length(), 24u);  // both rims and a slit from one to the other
}

TEST(Seed, IsADiscThatHoldsEveryFeature) {
  std::mt19937 random(3);
  for (const Shape& shape : all_shapes()) {
    const SurfaceMesh mesh = shape.soup.weld();
    for (int run = 0; run < 20; ++run) {
      std::vector<FaceId> order(mesh.faces.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = FaceId(i);
      std::shuffle(order.begin(), order.end(), random);
      std::uniform_real_distribution<double> unit(-1, 1);
      std::vector<SeedFeature> features;
      std::vector<FeaturePair> tree;
      for (std::uint32_t k = 0; k < 6; ++k) {
        features.push_back({{order[k], {0.2, 0.3, 0.5}}, {unit(random), unit(random)}});
        if (k > 0) tree.push_back({static_cast<std::uint32_t>(random() % k), k});
      }
      BridgedSurface surface(mesh);
      const auto seed = build_seed(surface, features, tree);
      ASSERT_TRUE(seed.has_value());
      ASSERT_EQ(seed->disc.broken_invariant(), "") << shape.name;
      for (std::size_t k = 0; k < features.size(); ++k) {
        ASSERT_EQ(seed->disc.faces()[seed->feature_faces[k]].mesh_face, features[k].surface.face);
        EXPECT_TRUE(seed->disc.pinned(seed->feature_faces[k]));
      }
      for (FaceId f : ids<FaceId>(mesh.faces.size())) ASSERT_LE(seed->disc.cover(f), seed->sheets);
    }
  }
}

}  // namespace
}  // namespace applique
