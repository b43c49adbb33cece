#include <cstdlib>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "support/random_decals.h"
#include "support/shapes.h"

namespace applique {
namespace {

/// Sticks 350 random decals on each ground with the patch checked after every step. The same ones each time,
/// unless RC_PARAMS says otherwise.
random_decals::Tally run(Overlap overlap) {
  setenv("RC_PARAMS", "seed=20261124 max_success=350", 0);
  struct Shape {
    std::string name;
    SurfaceMesh mesh;
    double size;
  };
  const std::vector<Shape> shapes = {{"plane", shapes::plane(40, 40, 4, 4, 0.3).weld(), 3},
                                     {"sphere", shapes::sphere(4, 1).weld(), 2},
                                     {"torus", shapes::torus(64, 32, 1, 0.45).weld(), 1.5}};
  random_decals::Tally tally;
  for (const Shape& shape : shapes) {
    const SurfaceQuery query(shape.mesh);
    const random_decals::Ground ground{shape.name, &shape.mesh, &query, shape.size};
    const bool sound = rc::check("random decals on a " + shape.name, [&] {
      std::mt19937 random(*rc::gen::noShrink(rc::gen::arbitrary<std::uint32_t>()));
      const DecalInput input = random_decals::random_decal(ground, random);
      SolveOptions options;
      options.overlap = overlap;
      options.check_patch = true;
      const std::string outcome = random_decals::outcome(solve_decal(shape.mesh, input, options));
      tally.add(shape.name, outcome);
      RC_ASSERT(!outcome.empty());
    });
    EXPECT_TRUE(sound);
  }
  return tally;
}

TEST(RandomDecals, AreSolvedOrTurnedDownWithAReason) {
  const auto tally = run(Overlap::stop);
  tally.print("applique");
  EXPECT_GT(tally.share_solved(), 0.95);
}

}  // namespace
}  // namespace applique
