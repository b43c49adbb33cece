#include "applique/embed/untangle.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "applique/base/predicates.h"

#include "support/shapes.h"

namespace applique {
namespace {

/// The plane [0,1]^2 of cells x cells quads as a tangle at rest, and where its vertices are.
struct Sheet {
  Tangle tangle;
  std::vector<Vec2> plane;

  explicit Sheet(int cells) {
    const shapes::Soup soup = shapes::plane(cells, cells, 1, 1, 0.3);
    const SurfaceMesh mesh = soup.weld();
    for (const Vec3& p : mesh.positions) plane.emplace_back(p.x(), p.y());
    for (const auto& face : mesh.faces) {
      tangle.faces.push_back({int(face[0].value), int(face[1].value), int(face[2].value)});
      const auto& f = tangle.faces.back();
      tangle.rest.push_back({plane[f[0]], plane[f[1]], plane[f[2]]});
    }
    tangle.fixed.assign(plane.size(), 0);
  }

  /// The face that holds `place` in the sheet at rest is to put it at `target`.
  void pin(Vec2 place, Vec2 target) {
    for (std::size_t t = 0; t < tangle.faces.size(); ++t) {
      const auto& c = tangle.rest[t];
      const double whole = cross(c[1] - c[0], c[2] - c[0]);
      std::array<double, 3> b;
      for (int k = 0; k < 3; ++k) b[k] = cross(c[(k + 1) % 3] - place, c[(k + 2) % 3] - place) / whole;
      if (b[0] < 0 || b[1] < 0 || b[2] < 0) continue;
      tangle.placed.push_back({tangle.faces[t], b, target});
      return;
    }
  }

  [[nodiscard]] double residual(const std::vector<Vec2>& at) const {
    double worst = 0;
    for (const PlacedPoint& point : tangle.placed) {
      Vec2 z = -point.target;
      for (int k = 0; k < 3; ++k) z += point.barycentric[k] * at[point.corners[k]];
      worst = std::max(worst, std::abs(z));
    }
    return worst;
  }

  [[nodiscard]] std::size_t flips(const std::vector<Vec2>& at) const {
    std::size_t count = 0;
    for (const auto& f : tangle.faces) count += orientation(at[f[0]], at[f[1]], at[f[2]]) <= 0;
    return count;
  }
};

TEST(Untangle, BringsRoundWhatRandomMovesHaveTurnedOver) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> move(-0.06, 0.06);
  Sheet sheet(24);
  for (Vec2& z : sheet.plane) z += Vec2(move(random), move(random));
  ASSERT_GT(sheet.flips(sheet.plane), 100U);
  const Untangled untangled = untangle(sheet.tangle, sheet.plane);
  EXPECT_EQ(untangled.flips, 0U);
  EXPECT_EQ(sheet.flips(untangled.plane), 0U);
}

/// Six points displaced by a tenth of the sheet at random, and a pair turned by 150 degrees, held exactly.
TEST(Untangle, HoldsThePlacedPointsExactly) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.2, 0.8), move(-0.1, 0.1);
  for (int round = 0; round < 5; ++round) {
    Sheet sheet(40);
    while (sheet.tangle.placed.size() < 6) {
      const Vec2 at(place(random), place(random));
      if (std::all_of(sheet.tangle.placed.begin(), sheet.tangle.placed.end(),
                      [&](const PlacedPoint& p) { return std::abs(p.target - at) > 0.15; }))
        sheet.pin(at, at + Vec2(move(random), move(random)));
    }
    const Untangled untangled = untangle(sheet.tangle, sheet.plane);
    EXPECT_EQ(untangled.flips, 0U);
    EXPECT_EQ(sheet.flips(untangled.plane), 0U);
    EXPECT_LT(sheet.residual(untangled.plane), 1e-12);
  }
  Sheet sheet(40);
  const Vec2 turn = std::polar(1.0, 150 * std::numbers::pi / 180), middle(0.5, 0.5);
  for (const Vec2 arm : {Vec2(0.15, 0), Vec2(-0.15, 0)}) sheet.pin(middle + arm, middle + turn * arm);
  for (const Vec2 corner : {Vec2(0.05, 0.05), Vec2(0.95, 0.05), Vec2(0.95, 0.95), Vec2(0.05, 0.95)})
    sheet.pin(corner, corner);
  const Untangled untangled = untangle(sheet.tangle, sheet.plane);
  EXPECT_EQ(untangled.flips, 0U);
  EXPECT_LT(sheet.residual(untangled.plane), 1e-12);
}

TEST(Untangle, LeavesWhatIsFixed) {
  Sheet sheet(16);
  for (std::size_t v = 0; v < sheet.plane.size(); ++v)
    sheet.tangle.fixed[v] = std::abs(sheet.plane[v] - Vec2(0.5, 0.5)) > 0.35;
  std::vector<Vec2> moved = sheet.plane;
  for (std::size_t v = 0; v < moved.size(); ++v)
    if (std::abs(moved[v] - Vec2(0.5, 0.5)) < 0.1) moved[v] += Vec2(0.25, 0);
  ASSERT_GT(sheet.flips(moved), 0U);
  const Untangled untangled = untangle(sheet.tangle, moved);
  EXPECT_EQ(untangled.flips, 0U);
  for (std::size_t v = 0; v < moved.size(); ++v)
    EXPECT_TRUE(!sheet.tangle.fixed[v] || untangled.plane[v] == moved[v]);
}

/// Three points of one triangle placed the other way round cannot be had without a fold.
TEST(Untangle, SaysWhatCannotBe) {
  Sheet sheet(8);
  const auto& c = sheet.tangle.rest[40];
  const auto& f = sheet.tangle.faces[40];
  for (int k = 0; k < 3; ++k) {
    std::array<double, 3> corner = {0, 0, 0};
    corner[k] = 1;
    sheet.tangle.placed.push_back({f, corner, c[k == 0 ? 0 : 3 - k]});
  }
  const Untangled untangled = untangle(sheet.tangle, sheet.plane);
  EXPECT_GT(untangled.flips, 0U);
  EXPECT_LT(sheet.residual(untangled.plane), 1e-12);
}

}  // namespace
}  // namespace applique
