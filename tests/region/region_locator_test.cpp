#include "applique/region/region_locator.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "region/contours.h"

namespace applique {
namespace {

Vec2 place(const RegionTriangulation& mesh, const RegionLocation& location) {
  Vec2 z = 0;
  for (int k = 0; k < 3; ++k) {
    z += location.barycentric[k] * mesh.points[mesh.triangles[location.triangle][k]];
  }
  return z;
}

RC_GTEST_PROP(RegionLocator, FindsTheNearestPlace, ()) {
  const Region region = random_star(*rc::gen::inRange(3, 80), *rc::gen::arbitrary<unsigned>());
  const double max_edge = *rc::gen::element(0.0, region.diameter() / 20);
  const RegionTriangulation mesh = triangulate_region(region, {}, {}, {max_edge});
  const RegionLocator locator(mesh);
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  std::uniform_real_distribution<double> x(-2, 2);
  std::vector<Vec2> points = {{1e6, -1e6}};
  for (int i = 0; i < 200; ++i) points.emplace_back(x(random), x(random));
  for (std::size_t i = 0; i < mesh.points.size(); i += 7) points.push_back(mesh.points[i]);
  for (const Vec2 z : points) {
    const RegionLocation location = locator.locate(z);
    double sum = 0;
    for (const double weight : location.barycentric) {
      RC_ASSERT(weight >= 0);
      sum += weight;
    }
    RC_ASSERT(std::abs(sum - 1) < 1e-12);
    const double distance = std::abs(place(mesh, location) - z);
    const double expected = region.contains(z) ? 0 : -region.signed_distance(z);
    RC_ASSERT(std::abs(distance - expected) < 1e-12 * (1 + std::abs(z)));
  }
}

}  // namespace
}  // namespace applique
