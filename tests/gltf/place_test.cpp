#include "place.h"

#include <cstring>

#include <gtest/gtest.h>

#include "gltf/test_models.h"

namespace applique {
namespace {

/// Two unit squares side by side in the plane z = 0, of two triangles each: mesh "left" with material "skin",
/// whose texture coordinates are (x, y), and mesh "right" with material "cloth", coordinates (x, y) too, so
/// from 1 to 2. A third node mirrors the left square into x < 0 when asked for.
struct Fixture {
  explicit Fixture(bool mirrored = false) {
    const std::string node_list = mirrored ? R"({"mesh":0,"scale":[-1,1,1]})" : R"({"mesh":0},{"mesh":1})";
    const std::string json = R"({"asset":{"version":"2.0"},"nodes":[)" + node_list + R"(],
      "materials":[{"name":"skin"},{"name":"cloth"},{"name":"unused"}],
      "meshes":[{"name":"left","primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":4,"material":0}]},
                {"name":"right","primitives":[{"attributes":{"POSITION":1,"TEXCOORD_0":3},"indices":4,"material":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"},
                   {"bufferView":0,"byteOffset":60,"componentType":5126,"count":5,"type":"VEC3"},
                   {"bufferView":1,"componentType":5126,"count":5,"type":"VEC2"},
                   {"bufferView":1,"byteOffset":40,"componentType":5126,"count":5,"type":"VEC2"},
                   {"bufferView":2,"componentType":5121,"count":6,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":120},{"buffer":0,"byteOffset":120,"byteLength":80},
                     {"buffer":0,"byteOffset":200,"byteLength":6}],
      "buffers":[{"byteLength":206}]})";
    std::vector<float> data;
    for (const float x0 : {0.F, 1.F})
      for (const auto& [x, y] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {0.F, 1.F}, {0.5F, 9.F}})
        data.insert(data.end(), {x0 + x, y, 0.F});
    for (const float x0 : {0.F, 1.F})
      for (const auto& [x, y] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {0.F, 1.F}, {0.5F, 9.F}})
        data.insert(data.end(), {x0 + x, y});
    std::vector<std::uint8_t> chunk(206);
    std::memcpy(chunk.data(), data.data(), 200);
    const std::array<std::uint8_t, 6> indices = {0, 1, 2, 0, 2, 3};
    std::memcpy(chunk.data() + 200, indices.data(), 6);
    model = decode_model(parse_document(make_glb(json, chunk), "squares.glb", "").value()).value();
  }

  [[nodiscard]] Result<Vec3> resolve(const Place& place) const {
    const ModelSurface surface = build_surface(model, nodes);
    const SurfaceQuery query(surface.mesh);
    APPLIQUE_TRY(const SurfacePoint point,
                 resolve_place(place, model, surface, query, "decal 'crest', feature 3"));
    return position_of(surface.mesh, point);
  }
  [[nodiscard]] Error error(const Place& place) const {
    const auto point = resolve(place);
    return point ? Error{ErrorCode::not_solved, "it was resolved"} : point.error();
  }

  Model model;
  std::vector<std::size_t> nodes;
};

void expect_at(const Result<Vec3>& found, const Vec3& expected) {
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT((*found - expected).norm(), 1e-9) << found->transpose();
}

TEST(ResolvePlace, FindsPositionsNearTheSurface) {
  const Fixture f;
  expect_at(f.resolve(PositionPlace{{0.3, 0.4, 0.01}, {}}), {0.3, 0.4, 0});
  expect_at(f.resolve(PositionPlace{{0.3, 0.4, 0.5}, 0.6}), {0.3, 0.4, 0});
  const Error far = f.error(PositionPlace{{0.3, 0.4, 0.5}, {}});
  EXPECT_EQ(far.code, ErrorCode::feature_too_far);
  EXPECT_EQ(
      far.message,
      "decal 'crest', feature 3: position (0.3, 0.4, 0.5) is 0.5 from the surface, more than the default "
      "max_distance, 2 % of the model's diagonal, 0.04472; the nearest point is (0.3, 0.4, 0)");
  EXPECT_NE(f.error(PositionPlace{{0.3, 0.4, 0.5}, 0.25}).message.find("more than its max_distance of 0.25"),
            std::string::npos);
}

TEST(ResolvePlace, FindsTextureCoordinates) {
  Fixture f;
  expect_at(f.resolve(UvPlace{{0.25, 0.75}, std::string("skin")}), {0.25, 0.75, 0});
  expect_at(f.resolve(UvPlace{{1.0, 0.5}, std::size_t{0}}), {1, 0.5, 0});
  // The sampler repeats: coordinates from 1 to 2 are those from 0 to 1 of the picture, and the other way
  // round.
  expect_at(f.resolve(UvPlace{{0.25, 0.75}, std::string("cloth")}), {1.25, 0.75, 0});
  expect_at(f.resolve(UvPlace{{-2.75, 3.75}, std::string("skin")}), {0.25, 0.75, 0});
  f.model.materials[1].wrap_u = WrapMode::mirror;
  expect_at(f.resolve(UvPlace{{0.25, 0.75}, std::string("cloth")}), {1.75, 0.75, 0});
  f.model.materials[1].wrap_u = WrapMode::clamp;
  const Error missed = f.error(UvPlace{{0.25, 0.75}, std::string("cloth")});
  EXPECT_EQ(missed.code, ErrorCode::feature_missed);
  EXPECT_EQ(missed.message,
            "decal 'crest', feature 3: no triangle of the material 'cloth' has the texture coordinates "
            "(0.25, 0.75)");
}

TEST(ResolvePlace, NamesMaterialsThatDoNotFit) {
  Fixture f;
  const Error unknown = f.error(UvPlace{{0, 0}, std::string("skim")});
  EXPECT_EQ(unknown.code, ErrorCode::feature_place_invalid);
  EXPECT_EQ(unknown.message, "decal 'crest', feature 3: the model has no material 'skim'; expected 'skin'");
  EXPECT_EQ(f.error(UvPlace{{0, 0}, std::size_t{7}}).message,
            "decal 'crest', feature 3: material 7 is not there: the model has 3 materials");
  EXPECT_EQ(f.error(UvPlace{{0, 0}, std::string("unused")}).message,
            "decal 'crest', feature 3: no triangle of the surface has the material 'unused'");
  f.model.parts[0].uvs.clear();
  EXPECT_EQ(f.error(UvPlace{{0, 0}, std::string("skin")}).code, ErrorCode::uvs_missing);
}

TEST(ResolvePlace, FindsVerticesAndTriangles) {
  const Fixture f;
  expect_at(f.resolve(VertexPlace{2, std::string("right"), 0}), {2, 1, 0});
  EXPECT_NE(f.error(VertexPlace{4, std::string("right"), 0}).message.find("is a corner of no triangle"),
            std::string::npos);
  EXPECT_NE(f.error(VertexPlace{5, std::string("right"), 0}).message.find("has 5 vertices"),
            std::string::npos);
  EXPECT_NE(f.error(VertexPlace{0, std::string("right"), 1}).message.find("is not on the surface"),
            std::string::npos);
  expect_at(f.resolve(TrianglePlace{1, {0.5, 0.25, 0.25}, std::string("left"), 0}), {0.25, 0.5, 0});
  EXPECT_NE(f.error(TrianglePlace{2, {1, 0, 0}, std::string("left"), 0}).message.find("has 2 triangles"),
            std::string::npos);
  EXPECT_EQ(f.error(TrianglePlace{1, {0.5, 0.25, 0.2}, std::string("left"), 0}).message,
            "decal 'crest', feature 3: the barycentric coordinates add up to 0.95 instead of 1");
  EXPECT_NE(f.error(TrianglePlace{1, {1.5, -0.5, 0}, std::string("left"), 0}).message.find("is negative"),
            std::string::npos);
}

TEST(ResolvePlace, KeepsTheFilesCornerOrderUnderAMirror) {
  const Fixture f(true);
  expect_at(f.resolve(TrianglePlace{0, {0.5, 0.5, 0}, std::string("left"), 0}), {-0.5, 0, 0});
}

TEST(ResolvePlace, AsksForTheNodeOfASharedMesh) {
  Fixture f;
  ModelPart copy = f.model.parts[0];
  copy.node = 5;
  for (Vec3& p : copy.positions) p.z() += 3;
  f.model.parts.push_back(copy);
  EXPECT_NE(f.error(VertexPlace{2, std::string("left"), 0}).message.find("is shown 2 times"),
            std::string::npos);
  f.nodes = {5};
  expect_at(f.resolve(VertexPlace{2, std::string("left"), 0}), {1, 1, 3});
}

TEST(ResolvePlace, ShootsRays) {
  const Fixture f;
  expect_at(f.resolve(RayPlace{{0.5, 0.25, 2}, {0, 0, -7}}), {0.5, 0.25, 0});
  const Error missed = f.error(RayPlace{{0.5, 0.25, 2}, {0, 0, 1}});
  EXPECT_EQ(missed.code, ErrorCode::feature_missed);
  EXPECT_EQ(
      missed.message,
      "decal 'crest', feature 3: the ray from (0.5, 0.25, 2) along (0, 0, 1) does not meet the surface");
}

}  // namespace
}  // namespace applique
