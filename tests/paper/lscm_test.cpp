#include "applique/paper/lscm.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace applique {
namespace {

/// A third of a tube, and where its vertices are when it is rolled out flat.
struct Strip {
  Strip()
      : mesh(
            shapes::grid(24, 10, [](double s, double t) { return Vec3(std::sin(2 * s), std::cos(2 * s), t); })
                .weld()),
        bridged(mesh),
        disc(bridged, FaceId(0)) {
    for (PatchFaceId q(0); q.value < disc.faces().size(); ++q.value)
      for (int k = 0; k < 3; ++k)
        if (!disc.faces()[q].neighbours[k].valid()) disc.glue(q, k, 1);
    disc.compact();
    for (PatchVertexId v : ids<PatchVertexId>(disc.vertex_count())) {
      const Vec3& p = disc.position(v);
      flat.emplace_back(std::atan2(p.x(), p.y()), p.z());
    }
    const auto corner = [&](double x, double y) {
      return static_cast<std::size_t>(std::min_element(flat.begin(), flat.end(),
                                                       [&](Vec2 a, Vec2 b) {
                                                         return std::abs(a - Vec2(x, y)) <
                                                                std::abs(b - Vec2(x, y));
                                                       }) -
                                      flat.begin());
    };
    pins = {corner(0, 0), corner(2, 1)};
    // Facets are chords of the tube.
    const double chord = 2 * std::sin(1.0 / 24) * 12;
    for (Vec2& z : flat) z = {z.real() * chord, z.imag()};
  }

  SurfaceMesh mesh;
  BridgedSurface bridged;
  ImmersedDisc disc;
  std::vector<Vec2> flat;
  std::array<std::size_t, 2> pins{};
};

double largest_difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double worst = 0;
  for (std::size_t v = 0; v < a.size(); ++v) worst = std::max(worst, std::abs(a[v] - b[v]));
  return worst;
}

TEST(Lscm, KeepsTheIsometryOfADevelopableStrip) {
  const Strip strip;
  ASSERT_EQ(strip.disc.live_faces(), strip.mesh.faces.size());
  const LscmResult result = solve_lscm(measure_disc(strip.disc), strip.flat, strip.pins);
  EXPECT_LT(largest_difference(result.plane, strip.flat), 1e-9);
  EXPECT_LE(result.iterations, 1);
}

TEST(Lscm, UnrollsADevelopableStripFromWhereItStandsStepByStep) {
  const Strip strip;
  const DiscGeometry disc = measure_disc(strip.disc);
  std::vector<Vec2> plane = strip.flat;
  for (std::size_t v = 0; v < plane.size(); ++v)
    if (v != strip.pins[0] && v != strip.pins[1])
      plane[v] += Vec2(0.3 * std::sin(5 * plane[v].imag()), 0.3 * std::cos(4 * plane[v].real()));
  double residual = 1;
  for (int solve = 0; solve < 12; ++solve) {
    LscmResult result = solve_lscm(disc, plane, strip.pins);
    EXPECT_LE(result.iterations, 100 + 4 * std::sqrt(double(plane.size())));
    plane = std::move(result.plane);
    residual = result.residual;
  }
  EXPECT_LT(residual, 1e-6);
  EXPECT_LT(largest_difference(plane, strip.flat), 1e-3);
  EXPECT_EQ(plane[strip.pins[0]], strip.flat[strip.pins[0]]);
}

}  // namespace
}  // namespace applique
