#include "tangent_turns.h"

#include <cmath>

#include <gtest/gtest.h>

namespace applique {
namespace {

/// A square of the plane z = 0, or a dome over it, in a layout that runs with x and y (v down) and in one
/// that is turned by `angle`, mirrored if wanted.
TangentFrames make_frames(double angle, bool mirrored, bool dome) {
  TangentFrames frames;
  for (int j = 0; j <= 4; ++j)
    for (int i = 0; i <= 4; ++i) {
      const double x = i / 2.0 - 1;
      const double y = j / 2.0 - 1;
      frames.positions.emplace_back(x, y, dome ? -0.3 * (x * x + y * y) : 0);
      frames.normals.emplace_back(dome ? 0.6 * x : 0, dome ? 0.6 * y : 0, 1);
    }
  for (std::uint32_t j = 0; j < 4; ++j)
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t k = 5 * j + i;
      frames.triangles.push_back({k, k + 1, k + 6});
      frames.triangles.push_back({k, k + 6, k + 5});
    }
  for (const auto& triangle : frames.triangles) {
    std::array<Texel, 3> before = {};
    std::array<Texel, 3> after = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = frames.positions[triangle[k]];
      before[k] = {p.x(), -p.y()};
      const double u = std::cos(angle) * p.x() + std::sin(angle) * p.y();
      const double v = -(std::cos(angle) * p.y() - std::sin(angle) * p.x());
      after[k] = {mirrored ? -u : u, v};
    }
    frames.old_corners.push_back(before);
    frames.new_corners.push_back(after);
  }
  return frames;
}

/// A direction of a frame in space.
Vec3 in_space(double x, double y, const Vec3& tangent, double side, const Vec3& normal) {
  return x * tangent + y * side * normal.cross(tangent);
}

TEST(TurnTangents, KeepDirectionsInSpace) {
  for (const bool dome : {false, true})
    for (const bool mirrored : {false, true})
      for (const double angle : {0.0, 0.4, 1.9, 3.0}) {
        const TangentFrames frames = make_frames(angle, mirrored, dome);
        const TangentTurns turned = turn_tangents(frames);
        for (std::size_t t = 0; t < frames.triangles.size(); ++t)
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 normal = frames.normals[frames.triangles[t][k]].normalized();
            const auto& tangent = turned.tangents[t][k];
            const Vec3 along(tangent[0], tangent[1], tangent[2]);
            EXPECT_NEAR(along.norm(), 1, 1e-6);
            EXPECT_NEAR(along.dot(normal), 0, 1e-6);
            EXPECT_EQ(tangent[3], mirrored ? -1 : 1);
            if (dome) continue;
            const FrameTurn& turn = turned.turns[t][k];
            const Vec3 before = in_space(0.6, -0.3, Vec3::UnitX(), 1, normal);
            const Vec3 after = in_space(turn.xx * 0.6 - turn.xy * 0.3, turn.yx * 0.6 - turn.yy * 0.3, along,
                                        tangent[3], normal);
            EXPECT_LT((before - after).norm(), 1e-6) << "angle " << angle;
          }
      }
}

TEST(TurnTangents, StartFromTheTangentsOfTheFile) {
  TangentFrames frames = make_frames(0.7, false, false);
  frames.tangents.assign(frames.positions.size(), {0, 2, 0, -1});  // any length
  const TangentTurns turned = turn_tangents(frames);
  const FrameTurn& turn = turned.turns[5][1];
  const auto& tangent = turned.tangents[5][1];
  const Vec3 before = in_space(0.6, -0.3, Vec3::UnitY(), -1, Vec3::UnitZ());
  const Vec3 after = in_space(turn.xx * 0.6 - turn.xy * 0.3, turn.yx * 0.6 - turn.yy * 0.3,
                              Vec3(tangent[0], tangent[1], tangent[2]), tangent[3], Vec3::UnitZ());
  EXPECT_LT((before - after).norm(), 1e-6);
}

TEST(TurnTangents, AgreeWithThemselves) {
  const TangentFrames frames = make_frames(0, false, true);
  EXPECT_TRUE(same_frames(frames.old_corners, frames.new_corners));
  for (const auto& corners : turn_tangents(frames).turns)
    for (const FrameTurn& turn : corners) {
      EXPECT_NEAR(turn.xx, 1, 1e-12);
      EXPECT_NEAR(turn.yy, 1, 1e-12);
      EXPECT_NEAR(turn.xy, 0, 1e-12);
    }
  const TangentFrames turned = make_frames(0.01, false, false);
  EXPECT_FALSE(same_frames(turned.old_corners, turned.new_corners));
  const TangentFrames mirrored = make_frames(0, true, false);
  EXPECT_FALSE(same_frames(mirrored.old_corners, mirrored.new_corners));
}

}  // namespace
}  // namespace applique
