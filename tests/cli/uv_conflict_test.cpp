// Texture coordinates that a decal cannot simply be baked through: shared, mirrored, tiled, collapsed or
// none.

#include "cli/uv_conflict.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "binary_edit.h"
#include "cli/same_look.h"
#include "gltf/test_models.h"

namespace applique {
namespace {

using nlohmann::json;

TEST_F(UvConflictTest, OneFaceOfABoxThatSharesItsTexture) {
  write_model({make_box()});
  const json job = job_at(0.1, -0.2);
  expect_same_look(job);
  const json report = bake(job);
  const int separated = report["textures"][0]["separated_triangles"];
  EXPECT_GE(separated, 32) << "half of the face at least";
  EXPECT_LE(separated, 128) << "no more than the face";
  EXPECT_EQ(report["textures"][0]["created"], false);
  const Model after = load("out.glb");
  EXPECT_TRUE(is_red(colour_near(after, {0.1, -0.2, 1})));
  EXPECT_TRUE(is_red(colour_near(after, {0.5, 0.2, 1})));
  EXPECT_FALSE(is_red(colour_near(after, {0.75, -0.2, 1})));
  EXPECT_GT(picture_difference("model.glb", "out.glb", 0), 50);
  for (const int azimuth : {90, 180, 270}) EXPECT_LT(picture_difference("model.glb", "out.glb", azimuth), 2);
  EXPECT_LT(picture_difference("model.glb", "unseen.glb", 0), 2);
  expect_valid("out.glb");
}

TEST_F(UvConflictTest, AMirroredHalf) {
  write_model({make_mirrored_wall()});
  const json job = job_at(-1, 0);
  expect_same_look(job);
  EXPECT_LT(picture_difference("model.glb", "unseen.glb", 0), 2);
  bake(job);
  const Model after = load("out.glb");
  EXPECT_TRUE(is_red(colour_near(after, {-1.1, 0.3, 0})));
  const auto other = colour_near(after, {1.1, 0.3, 0});
  const auto before = colour_near(load("model.glb"), {1.1, 0.3, 0});
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(other[c], before[c], 1e-9);
  expect_valid("out.glb");
}

TEST_F(UvConflictTest, AcrossTheMirror) {
  write_model({make_mirrored_wall()});
  const json job = job_at(0, 0);
  expect_same_look(job);
  bake(job);
  const Model after = load("out.glb");
  for (const double x : {-0.4, -0.1, 0.0, 0.1, 0.4})
    EXPECT_TRUE(is_red(colour_near(after, {x, 0.2, 0}))) << x;
  EXPECT_FALSE(is_red(colour_near(after, {0.8, 0.2, 0})));
}

TEST_F(UvConflictTest, TilesThroughATextureTransform) {
  write_model({make_plane("Wall", 8)});
  edit_model([](Document& document) {
    auto& texture = document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    texture["extensions"]["KHR_texture_transform"] = {
        {"scale", {3.5, 2.25}}, {"rotation", 0.3}, {"offset", {0.125, -7.25}}};
    document.json["extensionsUsed"] = {"KHR_texture_transform"};
  });
  const json job = job_at(0.2, 0.1);
  expect_same_look(job);
  bake(job);
  const Model after = load("out.glb");
  EXPECT_TRUE(is_red(colour_near(after, {0.5, -0.3, 0})));
  EXPECT_FALSE(is_red(colour_near(after, {-0.5, -0.3, 0})));
  expect_valid("out.glb");
}

TEST_F(UvConflictTest, NoTextureCoordinates) {
  for (const int material : {-1, 0, 1}) {
    SCOPED_TRACE(material);
    SmallMesh wall = make_plane("Wall", 8);
    wall.uvs.clear();
    wall.material = material;
    write_model({wall});
    const json job = job_at(0, 0);
    if (material != 0)
      expect_same_look(job);  // A texture without coordinates looks like nothing in particular.
    const json report = bake(job);
    EXPECT_EQ(report["decals"][0]["warnings"], json::array());
    const Model after = load("out.glb");
    for (const double x : {-0.45, 0.0, 0.45})
      for (const double y : {-0.45, 0.0, 0.45})
        EXPECT_TRUE(is_red(colour_near(after, {x, y, 0}))) << x << ", " << y;
    EXPECT_FALSE(is_red(colour_near(after, {0.6, 0, 0})));
    if (material != 0) expect_valid("out.glb");
  }
}

TEST_F(UvConflictTest, CollapsedTextureCoordinates) {
  SmallMesh wall = make_plane("Wall", 8);
  for (auto& uv : wall.uvs) uv = {0.3, 0.6};
  write_model({wall});
  const json job = job_at(0, 0);
  expect_same_look(job);
  bake(job);
  const Model after = load("out.glb");
  EXPECT_TRUE(is_red(colour_near(after, {0.45, 0.45, 0})));
  EXPECT_FALSE(is_red(colour_near(after, {0.55, 0.45, 0})));
}

TEST_F(UvConflictTest, AnInstanceOfAMesh) {
  write_model({make_box()});
  edit_model([](Document& document) {
    document.json["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}, {"scale", {-1, 1, 1}}});
    document.json["scenes"][0]["nodes"].push_back(1);
  });
  for (const double x : {0.0, 5.0}) {
    SCOPED_TRACE(x);
    const json job = job_at(x, 0);
    expect_same_look(job);
    bake(job);
    const Model after = load("out.glb");
    EXPECT_TRUE(is_red(colour_near(after, {x, 0, 1})));
    EXPECT_FALSE(is_red(colour_near(after, {5 - x, 0, 1})));
    expect_valid("out.glb");
  }
}

TEST_F(UvConflictTest, TwoDecalsOnOneFaceAndOneOnAnother) {
  write_model({make_box()});
  json job = job_at(-0.1, 0.1);
  job["decals"].push_back(job_at(0.3, -0.2)["decals"][0]);
  job["decals"].push_back(job["decals"][0]);
  job["decals"][1]["name"] = "second";
  job["decals"][2]["name"] = "right";
  job["decals"][2]["features"][0]["ray"] = {{"origin", {20, 0, 0}}, {"direction", {-1, 0, 0}}};
  const json report = bake(job);
  EXPECT_GE(report["textures"][0]["separated_triangles"], 64);
  EXPECT_LE(report["textures"][0]["separated_triangles"], 256);
  const Model after = load("out.glb");
  EXPECT_TRUE(is_red(colour_near(after, {-0.5, 0.5, 1})));
  EXPECT_TRUE(is_red(colour_near(after, {0.7, -0.6, 1})));
  EXPECT_TRUE(is_red(colour_near(after, {1, 0.4, 0.4})));
  EXPECT_FALSE(is_red(colour_near(after, {-1, 0.4, 0.4})));
}

TEST_F(UvConflictTest, KeepsSkinsAndMorphTargets) {
  SmallMesh wall = make_plane("Wall", 4);
  wall.uvs.clear();
  write_model({wall});
  const std::size_t count = wall.positions.size();
  edit_model([&](Document& document) {
    std::vector<double> joints, weights, offsets, colours;
    for (std::size_t i = 0; i < count; ++i) {
      joints.insert(joints.end(), {static_cast<double>(i % 2), 1, 0, 0});
      weights.insert(weights.end(), {127, 128, 0, 0});
      offsets.insert(offsets.end(), {0, 0, 0.01 * static_cast<double>(i)});
      colours.insert(colours.end(), {255, static_cast<double>(i), 7});
    }
    auto& root = document.json;
    const auto add = [&](const char* type, int component, const std::vector<double>& values, int width,
                         bool normalized, bool bounds) {
      Document::Json entry = {{"componentType", component}, {"type", type}};
      if (normalized) entry["normalized"] = true;
      return add_accessor(document, entry, values, width, bounds, 34962);
    };
    Document::Json attributes = root["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = add("VEC4", 5121, joints, 4, false, false);
    attributes["WEIGHTS_0"] = add("VEC4", 5121, weights, 4, true, false);
    attributes["COLOR_0"] = add("VEC3", 5121, colours, 3, true, false);
    const std::size_t target = add("VEC3", 5126, offsets, 3, false, true);
    auto& primitive = root["meshes"][0]["primitives"][0];
    primitive["attributes"] = attributes;
    primitive["targets"] = Document::Json::array({{{"POSITION", target}}});
    root["meshes"][0]["weights"] = {0.5};
    root["nodes"].push_back({{"name", "joint"}});
    root["nodes"].push_back({{"name", "other joint"}, {"translation", {0, 0, 0.5}}});
    root["nodes"][0]["skin"] = 0;
    root["skins"] = Document::Json::array({{{"joints", {1, 2}}}});
    root["scenes"][0]["nodes"] = {0, 1, 2};
  });
  const Model before = load("model.glb");
  bake(job_at(0, 0));
  const Model after = load("out.glb");
  ASSERT_EQ(after.parts.size(), 2u);
  const LookDifference difference = compare_looks(before, after);
  EXPECT_EQ(difference.missing, 0u) << "skinned and morphed, every triangle is where it was";
  const auto& primitives = after.document.json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  for (const char* name : {"JOINTS_0", "WEIGHTS_0", "COLOR_0", "POSITION"}) {
    ASSERT_TRUE(primitives[1]["attributes"].contains(name)) << name;
    const auto& old_accessor =
        before.document
            .json["accessors"]
                 [before.document.json["meshes"][0]["primitives"][0]["attributes"][name].get<std::size_t>()];
    const auto& accessor =
        after.document.json["accessors"][primitives[1]["attributes"][name].get<std::size_t>()];
    for (const char* key : {"componentType", "type", "normalized"})
      EXPECT_EQ(accessor.value(key, Document::Json()), old_accessor.value(key, Document::Json())) << name;
  }
  EXPECT_EQ(primitives[1]["targets"].size(), 1u);
  expect_valid("out.glb");
}

/// Half of the triangles under the decal have more texels than it has pixels, the others next to none.
TEST_F(UvConflictTest, KeepsDetailWhereTheOldTextureHasLittleRoom) {
  SmallMesh wall = make_mirrored_wall();
  for (auto& uv : wall.uvs) uv[0] = uv[0] > 0.75 ? 1 - 3.6 * (1 - uv[0]) : 0.07 + 0.04 * uv[0];
  write_model({wall});
  json job = job_at(0.5, 0);
  job["texture_size"] = 2048;
  bake(job);
  const Model after = load("out.glb");
  double texels = 0;  // across the narrow half, 32 pixels of the decal
  for (const ModelPart& part : after.parts) {
    std::map<double, double> u;
    for (std::size_t i = 0; i < part.uvs.size(); ++i)
      if (part.positions[i].y() == 0) u[part.positions[i].x()] = part.uvs[i][0];
    if (!u.contains(0.5) || !u.contains(1)) continue;
    const auto image = after.materials[*part.material].image;
    texels = std::max(texels, std::abs(u[1] - u[0.5]) * load_model_image(after, *image).value().width);
  }
  EXPECT_GT(texels, 5) << "it was 1.3";
}

/// A texel for each of its pixels would take many textures for the triangle round it.
TEST_F(UvConflictTest, ATinyDecalGetsNoMoreThanTheTextureThatIsAskedFor) {
  write_model({make_mirrored_wall()});
  for (const double size : {1e-3, 1e-6}) {
    json job = job_at(0.4, 0.1);
    job["decals"][0]["size"] = size;
    const json report = bake(job);
    EXPECT_LT(report["decals"][0]["texel_density"]["texels_per_pixel"], 0.5);
    ASSERT_FALSE(report["decals"][0]["warnings"].empty());
    EXPECT_EQ(report["decals"][0]["warnings"].back()["code"], "low_texel_density");
    const Model after = load("out.glb");
    int images = 0;
    for (const ModelMaterial& material : after.materials) {
      if (!material.image) continue;  // Of the triangles that are as they were.
      ++images;
      const Image image = load_model_image(after, *material.image).value();
      EXPECT_LE(std::max(image.width, image.height), 2 * 256) << "twice \"texture_size\"";
    }
    EXPECT_GT(images, 0);
  }
}

TEST_F(UvConflictTest, ErrorNamesTheDecalTheMaterialAndTheTexels) {
  write_model({make_box()});
  json job = job_at(0, 0);
  job["decals"][0]["uv_conflict"] = "error";
  folder_.write("job.json", job);
  const CommandResult result = folder_.run("bake job.json -o out.glb");
  EXPECT_EQ(result.status, 3);
  for (const char* part : {"'crest'", "'paint'", "texels", "shown by other triangles", "separate"})
    EXPECT_NE(result.err.find(part), std::string::npos) << part << "\nin: " << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.glb"));

  write_model({make_plane("Wall", 8)});
  EXPECT_EQ(bake(job)["textures"][0]["separated_triangles"], 0) << "nothing is shared there";
}

TEST_F(UvConflictTest, SharePutsItOnEveryFace) {
  write_model({make_box()});
  json job = job_at(0, 0);
  job["decals"][0]["uv_conflict"] = "share";
  const json report = bake(job);
  EXPECT_EQ(report["textures"][0]["separated_triangles"], 0);
  ASSERT_FALSE(report["decals"][0]["warnings"].empty());
  EXPECT_EQ(report["decals"][0]["warnings"][0]["code"], "uv_overlap");
  EXPECT_TRUE(is_red(colour_near(load("out.glb"), {0, 0, -1})));
}

TEST_F(UvConflictTest, SharesUpToTheBordersOfIslands) {
  // Stacked islands, of which one is a little larger.
  SmallMesh front = make_plane("Front", 8), back = make_plane("Back", 8, 0, -1);
  for (auto& uv : front.uvs)
    for (double& x : uv) x = 0.5 + 0.8 * (x - 0.5);
  for (auto& uv : back.uvs)
    for (double& x : uv) x = 0.5 + 0.82 * (x - 0.5);
  for (const auto& t : back.triangles) front.triangles.push_back({t[0] + 81, t[1] + 81, t[2] + 81});
  front.positions.insert(front.positions.end(), back.positions.begin(), back.positions.end());
  front.uvs.insert(front.uvs.end(), back.uvs.begin(), back.uvs.end());
  write_model({front});
  json job = job_at(0.7, 0);
  job["decals"][0].update({{"uv_conflict", "share"}});
  bake(job);
  const Model after = load("out.glb");
  for (const double y : {-0.4, -0.1, 0.05, 0.3}) {
    EXPECT_TRUE(is_red(colour_near(after, {0.999, y, 0}))) << y;
    EXPECT_TRUE(is_red(colour_near(after, {0.999, y, -1}))) << y;
    EXPECT_FALSE(is_red(colour_near(after, {0.1, y, -1}))) << y;
  }
}

TEST_F(UvConflictTest, SharesBesideADecalThatIsSeparated) {
  write_model({make_mirrored_wall()});
  write_png(folder_ / "blue.png", make_image(image_size, image_size, {0, 0, 0xffff, 0xffff}));
  json job = job_at(-1.5, 0);
  json shared = job_at(-1, 0.05)["decals"][0];
  job["decals"][0].update({{"name", "own"}, {"image", "blue.png"}, {"size", 0.4}});
  shared.update({{"uv_conflict", "share"}, {"size", 0.8}});
  job["decals"].push_back(shared);
  const json report = bake(job);
  EXPECT_EQ(report["textures"].size(), 2u);
  const Model before = load("model.glb"), after = load("out.glb");
  // Across the cut, which runs along the squares' sides and diagonals, and on what shares the texels.
  for (const double y : {-0.3, -0.251, -0.12, -0.01, 0.002, 0.127, 0.248, 0.252, 0.4})
    for (const double x : {-1.35, -1.24, -1.13, -1.01, -1.003, -0.998, -0.99, -0.85, -0.65})
      for (const double side : {1, -1}) {
        const auto colour = colour_near(after, {side * x, y, 0});
        EXPECT_TRUE(is_red(colour)) << side * x << ", " << y << ": " << colour[0] << ' ' << colour[1];
      }
  EXPECT_GT(colour_near(after, {-1.6, 0, 0})[2], 253);
  const auto other = colour_near(after, {1.6, 0, 0}), old = colour_near(before, {1.6, 0, 0});
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(other[c], old[c], 1e-9);
  expect_valid("out.glb");
  // Nothing of it lies on triangles that are not separated: all the same the others show it.
  job["decals"][1]["size"] = 0.2;
  job["decals"][1]["features"][0]["ray"]["origin"] = {-1.5, 0, 20};
  bake(job);
  EXPECT_TRUE(is_red(colour_near(load("out.glb"), {1.5, 0.05, 0})));
  EXPECT_TRUE(is_red(colour_near(load("out.glb"), {-1.5, 0.05, 0})));
}

TEST_F(UvConflictTest, LeavesAModelWithoutConflictAlone) {
  write_model({make_plane("Wall", 8)});
  const json report = bake(job_at(0, 0));
  EXPECT_EQ(report["textures"][0]["separated_triangles"], 0);
  const Model before = load("model.glb");
  const Model after = load("out.glb");
  EXPECT_EQ(after.document.json["meshes"], before.document.json["meshes"]);
  EXPECT_EQ(after.document.json["accessors"], before.document.json["accessors"]);
}

/// Every slot of a material, all of one texture size, goes into the atlas.
TEST_F(UvConflictTest, ResamplesEverySlot) {
  write_model({make_box()}, 64);
  edit_model([](Document& document) {
    auto& material = document.json["materials"][0];
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"] = 0;
    material["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
    material["occlusionTexture"]["index"] = 0;
    material["emissiveTexture"]["index"] = 0;
    material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"] = {{"index", 0}};
    document.json["extensionsUsed"] = {"KHR_materials_clearcoat"};
  });
  json job = job_at(0, 0);
  expect_same_look(job);
  const Model after = load("unseen.glb");
  const ModelPart& part = after.parts.back();
  const auto& material = after.document.json["materials"][*part.material];
  EXPECT_EQ(material["normalTexture"]["scale"], 0.5);
  EXPECT_EQ(material["occlusionTexture"]["index"],
            material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"])
      << "slots that shared a texture still do";
  const Image old = load_model_image(load("model.glb"), 0).value();
  for (const auto& slot :
       {material["pbrMetallicRoughness"]["metallicRoughnessTexture"], material["normalTexture"],
        material["occlusionTexture"], material["emissiveTexture"],
        material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]}) {
    const auto texture = slot["index"].get<std::size_t>();
    const Image image =
        load_model_image(after, after.document.json["textures"][texture]["source"].get<std::size_t>())
            .value();
    // The middle of the separated face shows the texel right below the middle of the old texture.
    double u = 0, v = 0;
    for (std::size_t i = 0; i < part.uvs.size(); ++i)
      if (part.positions[i] == Vec3(0, 0, 1)) {
        u = part.uvs[i][0];
        v = part.uvs[i][1];
      }
    const auto x = static_cast<int>(std::lround(u * image.width)),
               y = static_cast<int>(std::lround(v * image.height));
    for (int c = 0; c < 3; ++c) EXPECT_EQ(image.pixel(x, y)[c], old.pixel(32, 32)[c]);
  }
}

/// Moves all texture coordinates that have a KHR_texture_transform by 1: the same picture, where textures
/// repeat.
void move_by_a_repeat(Document::Json& object) {
  for (auto& item : object.items()) {
    if (item.key() == "KHR_texture_transform") item.value()["offset"] = {1, 0};
    if (item.value().is_structured()) move_by_a_repeat(item.value());
  }
}

struct RealModel {
  const char* file;
  Vec3 origin, direction, up;
  double size;
};

/// Third-party models with every kind of conflict: the look stays, the decal comes, the files are valid.
TEST_F(UvConflictTest, ThirdPartyModels) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  write_png(folder_ / "small.png", make_image(16, 16, {0xffff, 0, 0, 0xffff}));
  for (const RealModel& real :
       {RealModel{"Duck.glb", {0.5, 1.3, 3}, {0, 0, -1}, {0, 1, 0}, 0.35},
        RealModel{"BoxTexturedNonPowerOfTwo.glb", {0.1, 0.05, 3}, {0, 0, -1}, {0, 1, 0}, 0.5},
        RealModel{"RiggedFigure.glb", {0, 1, 3}, {0, 0, -1}, {0, 1, 0}, 0.2},
        RealModel{"CesiumMilkTruck.glb", {0, 1.8, 6}, {0, 0, -1}, {0, 1, 0}, 1},
        RealModel{"SheenCloth.glb", {0, 3, 0}, {0, -1, 0}, {0, 0, -1}, 0.01},
        RealModel{"house.glb", {-0.11, 0.09, 3}, {0, 0, -1}, {0, 1, 0}, 0.01},
        RealModel{"Box_Draco.glb", {0.1, 0.05, 3}, {0, 0, -1}, {0, 1, 0}, 0.4},
        RealModel{"AnimatedMorphSphere.glb", {0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 0.3}}) {
    SCOPED_TRACE(real.file);
    if (!std::filesystem::exists(test_data() / "gltf" / real.file)) continue;
    std::filesystem::copy_file(test_data() / "gltf" / real.file, folder_ / "model.glb",
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::permissions(folder_ / "model.glb", std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::add);
    json job = job_at(0, 0);
    job.erase("texture_size");
    const auto list = [](const Vec3& v) { return json{v.x(), v.y(), v.z()}; };
    job["decals"][0].update({{"size", real.size}, {"up", list(real.up)}});
    job["decals"][0]["features"][0]["ray"] = {{"origin", list(real.origin)},
                                              {"direction", list(real.direction)}};
    expect_same_look(job);
    // So near that every texel is seen. A finely woven cloth repeats its textures so often that its look
    // hangs on how coordinates are rounded: as many pixels differ once these are moved by a whole repeat.
    json near = job;
    near["decals"][0]["size"] = real.size / 4;
    const Image before = close_up(near, false);
    double by_rounding = 0;
    if (real.file == std::string("SheenCloth.glb")) {
      Document moved = load_document(folder_ / "model.glb").value();
      move_by_a_repeat(moved.json["materials"]);
      ASSERT_TRUE(save_document(moved, folder_ / "moved.glb"));
      by_rounding = share_that_differs(before, close_up(near, false, "moved.glb"));
      EXPECT_LT(by_rounding, 1e-3);
    }
    EXPECT_LE(share_that_differs(before, close_up(near, true)), 2 * by_rounding);
    // From afar mip levels are seen. Those of a texture whose sides are no powers of two depend on where its
    // texels lie. (Those of one that is made finer for the decal, as this one is not, lie between the old
    // ones.)
    json coarse = job;
    coarse["decals"][0].update({{"image", "small.png"}, {"opacity", 0}});
    coarse["decals"][0]["features"][0]["image"] = {8, 8};
    bake(coarse, "coarse.glb");
    const bool odd_sides = real.file == std::string("BoxTexturedNonPowerOfTwo.glb");
    for (const int azimuth : {0, 90})
      EXPECT_LE(picture_difference("model.glb", "coarse.glb", azimuth), odd_sides ? 13 : 4) << azimuth;
    const json report = bake(job);
    ASSERT_TRUE(report.is_object());
    for (const auto& texture : report["textures"]) EXPECT_EQ(texture["shared_texels"], 0);
    EXPECT_GE(report["decals"][0]["texel_density"]["texels_per_pixel"], 0.5);
    const auto position = report["decals"][0]["features"][0]["position"].get<std::array<double, 3>>();
    EXPECT_TRUE(is_red(colour_near(load("out.glb"), {position[0], position[1], position[2]})));
    expect_valid("out.glb");
  }
}

}  // namespace
}  // namespace applique
