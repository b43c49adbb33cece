#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bake_plan.h"
#include "cli/command.h"
#include "cli/small_model.h"
#include "overlay_mesh.h"
#include "save_document.h"
#include "solve_job.h"

using namespace applique;
using nlohmann::json;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double height = 6;
constexpr int sides = 3;

/// Corner k of the pole's foot.
Vec3 foot(int k) {
  const double angle = 2 * pi * k / sides;
  return {std::cos(angle), std::sin(angle), 0};
}

Vec3 normal_of(int side) {
  const double angle = 2 * pi * (side + 0.5) / sides;
  return {std::cos(angle), std::sin(angle), 0};
}

/// A pole of six triangles; each side has a third of the texture.
SmallMesh make_pole() {
  SmallMesh mesh{"Pole", {}, {}, {}, {}, 0};
  for (int side = 0; side < sides; ++side) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const double up : {0.0, 1.0})
      for (const int end : {0, 1}) {
        mesh.positions.push_back(foot(side + end) + Vec3(0, 0, height * up));
        mesh.normals.push_back(normal_of(side));
        mesh.uvs.push_back({(side + 0.05 + 0.9 * end) / sides, 1 - up});
      }
    mesh.triangles.push_back({first, first + 1, first + 3});
    mesh.triangles.push_back({first, first + 3, first + 2});
  }
  return mesh;
}

/// Where a place of the pole's side is in its texture.
std::array<double, 2> uv_of(const Vec3& place, int side) {
  const Vec3 along = foot(side + 1) - foot(side);
  const double end = (Vec3(place.x(), place.y(), 0) - foot(side)).dot(along) / along.squaredNorm();
  return {(side + 0.05 + 0.9 * end) / sides, 1 - place.z() / height};
}

/// Along the middle of a ribbon that winds round the pole.
json pins_of(double turns, int pins) {
  json features = json::array();
  for (int k = 0; k <= pins; ++k) {
    const double turn = turns * k / pins + 0.02;
    const double s = sides * turn - std::floor(sides * turn);
    const int side = static_cast<int>(sides * turn);
    const Vec3 place = (1 - s) * foot(side) + s * foot(side + 1) + Vec3(0, 0, 2 + 0.9 * turn);
    features.push_back(
        {{"image", {50 + 1500.0 * k / pins, 50}}, {"position", {place.x(), place.y(), place.z()}}});
  }
  return features;
}

/// A ribbon two and a half times round the pole, which only a finer one can carry.
class DividedDecalTest : public testing::Test {
 protected:
  void SetUp() override {
    write_small_model(folder_ / "model.glb", {make_pole()}, {{"paint", make_noise(256), {1, 1, 1, 1}}});
    write_png(folder_ / "image.png", make_image(1600, 100, {65535, 0, 0, 65535}));
    folder_.write("job.json", {{"version", 1},
                               {"model", "model.glb"},
                               {"decals", json::array({{{"name", "ribbon"},
                                                        {"image", "image.png"},
                                                        {"overlap", "allow"},
                                                        {"features", pins_of(2.5, 16)}}})}});
    solve();
    ASSERT_NE(decal().map.divided, nullptr);
  }

  void solve() {
    const auto job = load_job(folder_ / "job.json");
    ASSERT_TRUE(job) << job.error().message;
    auto solved = solve_job(*job);
    ASSERT_TRUE(solved) << solved.error().message;
    job_ = std::move(*solved);
  }

  const SolvedDecal& decal() const { return job_.decals.front(); }

  CommandFolder folder_;
  SolvedJob job_;
};

TEST_F(DividedDecalTest, LiesOnThePoleWithoutStretch) {
  EXPECT_EQ(decal().map.quality.flipped_image, 0U);
  EXPECT_LT(decal().map.quality.l2_stretch, 1.01);
  EXPECT_GT(decal().map.quality.coverage, 0.99);
  for (const double residual : decal().map.quality.feature_residual) EXPECT_LT(residual, 1e-6);
  for (std::size_t k = 0; k < decal().features.size(); ++k) {
    const Vec3 place = position_of(decal().whole_surface->mesh, decal().features[k].surface);
    const auto& asked = std::get<PositionPlace>(decal().job.features[k].place).position;
    EXPECT_LT((place - asked).norm(), 1e-6);
  }
}

TEST_F(DividedDecalTest, PartsLieWhereTheyAreInTheTexture) {
  Document document = job_.model.document;
  const auto targets = plan_bake(job_, document);
  ASSERT_TRUE(targets);
  const BakeTarget& target = targets->front();
  const BakeTransfer transfer = lay_out_transfer(job_, target, target.shares.front(), 256, 256);
  const DecalMap& map = decal().map;
  std::size_t i = 0;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size())) {
    if (map.textured[f] == 0) continue;
    const FaceId face = map.patch.faces[f].mesh_face;
    const int side = static_cast<int>(decal().surface->source(face).triangle / 2);
    const auto corners = decal().surface->mesh.corners(face);
    const TransferFace& laid = transfer.faces.at(i++);
    for (int k = 0; k < 3; ++k) {
      const auto uv = uv_of(corners[k], side);
      EXPECT_NEAR(laid.texel[k][0], 256 * uv[0], 1e-4);
      EXPECT_NEAR(laid.texel[k][1], 256 * uv[1], 1e-4);
    }
  }
  EXPECT_EQ(i, transfer.faces.size());
  EXPECT_GT(i, 3 * 6U);
}

/// A skin moves corners, and what a viewer draws between them is straight.
TEST_F(DividedDecalTest, AnOverlayOnASkinKeepsToWholeTrianglesAndSaysSo) {
  Document document = load_document(folder_ / "model.glb").value();
  document.json["skins"] = {{{"joints", {1}}}};
  document.json["nodes"].push_back({{"name", "joint"}});
  document.json["nodes"][0]["skin"] = 0;
  ASSERT_TRUE(save_document(document, folder_ / "model.glb"));
  json job = json::parse(folder_.read("job.json"));
  ASSERT_NO_FATAL_FAILURE(solve());
  EXPECT_NE(decal().map.divided, nullptr) << "a bake may have parts";
  job["decals"][0]["output"] = "overlay";
  job["decals"][0]["overlap"] = "stop";
  job["decals"][0]["features"] = pins_of(3, 12);
  folder_.write("job.json", job);
  ASSERT_NO_FATAL_FAILURE(solve());
  EXPECT_EQ(decal().map.divided, nullptr);
  EXPECT_EQ(decal().surface, decal().whole_surface);
  EXPECT_TRUE(std::any_of(decal().warnings.begin(), decal().warnings.end(),
                          [](const Warning& warning) { return warning.code == "overlay_coarse"; }));
}

TEST_F(DividedDecalTest, ItsMeshLiesOnTheSides) {
  const DecalMesh mesh = build_overlay_mesh(job_.model, decal(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const FaceId face = decal().map.patch.faces[mesh.faces[t]].mesh_face;
    const auto& source = decal().surface->source(face);
    const Vec3 normal = normal_of(static_cast<int>(source.triangle / 2));
    const auto& triangle = job_.model.parts[source.part].triangles[source.triangle];
    for (const std::uint32_t v : mesh.triangles[t]) {
      EXPECT_NEAR(mesh.positions[v].dot(normal), std::cos(pi / sides), 1e-6);
      EXPECT_LT((mesh.normals[v] - normal).norm(), 1e-6);
      // What moves the model's vertices moves the mesh's by these weights.
      const auto weights = weights_in_source(decal(), mesh.origins[v], mesh.faces[t]);
      Vec3 place = Vec3::Zero();
      for (int k = 0; k < 3; ++k) place += weights[k] * job_.model.parts[source.part].positions[triangle[k]];
      EXPECT_LT((place - mesh.positions[v]).norm(), 1e-6);
    }
  }
}

}  // namespace
