// Separated triangles: what is told of them, every slot and instance, how their textures are stored, and
// materials with what cannot be resampled.

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "binary_edit.h"
#include "cli/same_look.h"
#include "cli/uv_conflict.h"
#include "edit.h"

namespace applique {
namespace {

using nlohmann::json;
using Json = Document::Json;

class UvSeparationTest : public UvConflictTest {
 protected:
  void SetUp() override {
    UvConflictTest::SetUp();
    Image relief = make_image(image_size, image_size, {204 * 257, 128 * 257, 230 * 257, 0xffff});
    relief.channels = 3;
    write_png(folder_ / "relief.png", relief);
  }

  /// Runs `check`, which ends with `status`; returns the report.
  json check(const json& job, int status = 0) {
    folder_.write("job.json", job);
    std::filesystem::remove(folder_ / "report.json");
    const CommandResult result = folder_.run("check job.json --report report.json");
    EXPECT_EQ(result.status, status) << result.err;
    said_ = result.out + result.err;
    return read_report();
  }

  void expect_said(std::initializer_list<const char*> parts) {
    for (const char* part : parts)
      EXPECT_NE(said_.find(part), std::string::npos) << part << "\nin: " << said_;
  }

  /// Gives the first primitive a further set of coordinates, made of those of its first.
  static void add_uvs(Document& document, int set,
                      const std::function<std::array<double, 2>(double, double)>& function) {
    const Model model = decode_model(document).value();
    std::vector<double> uvs;
    for (const auto& [u, v] : model.parts[0].uvs)
      for (const double x : function(u, v)) uvs.push_back(x);
    const std::size_t accessor =
        add_accessor(document, {{"componentType", 5126}, {"type", "VEC2"}}, uvs, 2, false, 34962);
    document.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_" + std::to_string(set)] = accessor;
  }

  /// Adds a texture, and returns its index.
  static std::size_t add_texture(Document& document, const Image& image) {
    const std::size_t added = add_image(document, encode_png(image).value(), "added");
    document.json["textures"].push_back({{"source", added}});
    return document.json["textures"].size() - 1;
  }

  /// The model with the texture of another slot as its base colour.
  static Model showing(const Model& model, const SlotPointer& slot) {
    Document document = model.document;
    for (auto& material : document.json["materials"]) {
      material["pbrMetallicRoughness"].erase("baseColorTexture");
      if (material.contains(slot)) material["pbrMetallicRoughness"]["baseColorTexture"] = material[slot];
    }
    return decode_model(std::move(document)).value();
  }

  /// The images behind the material of the last primitive of the first mesh.
  static std::vector<std::size_t> images_of_separated(const Model& model) {
    const auto material = model.document.json["meshes"][0]["primitives"].back()["material"];
    std::vector<std::size_t> images;
    const std::function<void(const Json&)> visit = [&](const Json& object) {
      for (const auto& item : object.items()) {
        if (!item.value().is_object()) continue;
        if (item.key().ends_with("Texture")) {
          const auto& texture = model.document.json["textures"][item.value()["index"].get<std::size_t>()];
          images.push_back(texture.contains("source")
                               ? texture["source"].get<std::size_t>()
                               : texture["extensions"]["EXT_texture_webp"]["source"].get<std::size_t>());
        }
        visit(item.value());
      }
    };
    visit(model.document.json["materials"][material.get<std::size_t>()]);
    return images;
  }

  std::string said_;  ///< By the last check.
};

const SlotPointer normal_slot("/normalTexture");

TEST_F(UvSeparationTest, CheckTellsOfSharedTexels) {
  write_model({make_box()});
  json job = job_at(0, 0);
  const json conflicts = check(job)["decals"][0]["uv_conflicts"];
  ASSERT_EQ(conflicts.size(), 1u);
  const json& conflict = conflicts[0];
  EXPECT_EQ(conflict["material"], "paint");
  EXPECT_EQ(conflict["slots"], json::array({"baseColor"}));
  EXPECT_EQ(conflict["reason"], "shared");
  EXPECT_EQ(conflict["outcome"], "separate");
  EXPECT_EQ(conflict["triangles_in_conflict"], conflict["triangles"]);
  EXPECT_EQ(conflict["shared_texels"], conflict["covered_texels"]);
  expect_said({"'crest'", "'paint'", "shown by other triangles", "texture space of their own"});
  EXPECT_EQ(bake(job)["decals"][0]["uv_conflicts"], conflicts) << "a bake says the same";
  EXPECT_EQ(read_report()["textures"][0]["separated_triangles"], conflict["triangles"]);

  job["decals"][0]["uv_conflict"] = "share";
  const json shared = check(job)["decals"][0];
  EXPECT_EQ(shared["uv_conflicts"][0]["outcome"], "share");
  EXPECT_EQ(shared["warnings"][0]["code"], "uv_conflict");
  expect_said({"appears on the others"});

  job["decals"][0]["uv_conflict"] = "error";
  EXPECT_EQ(check(job, 3)["decals"][0]["uv_conflicts"][0]["outcome"], "error");
  expect_said({"error", "'crest'", "\"separate\"", "\"share\"", "\"overlay\""});
}

TEST_F(UvSeparationTest, DetailThatIsLostBySharingIsWarnedOf) {
  SmallMesh wall = make_plane("Wall", 8);
  for (auto& uv : wall.uvs) uv = {0.01 * uv[0], 0.01 * uv[1]};
  write_model({wall});
  json job = job_at(0, 0);
  job["decals"][0]["uv_conflict"] = "share";
  for (const json& report : {check(job), bake(job)}) {
    const json& warnings = report["decals"][0]["warnings"];
    ASSERT_FALSE(warnings.empty());
    EXPECT_EQ(warnings[0]["code"], "uv_conflict");
    EXPECT_NE(warnings[0]["message"].get<std::string>().find("its detail is lost there"), std::string::npos)
        << warnings;
  }
}

TEST_F(UvSeparationTest, CheckTellsOfMissingCoordinates) {
  SmallMesh wall = make_plane("Wall", 8);
  wall.uvs.clear();
  wall.material = -1;
  write_model({wall});
  json job = job_at(0, 0);
  const json conflict = check(job)["decals"][0]["uv_conflicts"][0];
  EXPECT_EQ(conflict["material"], nullptr);
  EXPECT_EQ(conflict["reason"], "missing");
  EXPECT_EQ(conflict["outcome"], "separate");
  expect_said({"'Wall'", "no texture coordinates", "texture space of their own"});
  // Nothing is there to be shared.
  for (const char* wish : {"share", "error"}) {
    job["decals"][0]["uv_conflict"] = wish;
    EXPECT_EQ(check(job, 3)["decals"][0]["uv_conflicts"][0]["outcome"], "error");
    expect_said({"\"separate\"", "\"overlay\""});
    EXPECT_EQ(said_.find("\"share\""), std::string::npos) << said_;
  }
}

TEST_F(UvSeparationTest, CheckFindsNothingWrongWithAPlane) {
  write_model({make_plane("Wall", 8)});
  EXPECT_EQ(check(job_at(0, 0))["decals"][0]["uv_conflicts"], json::array());
}

/// The relief's coordinates are tiled, the colour's are not: by a set of their own, or a transform.
TEST_F(UvSeparationTest, ASlotOnOtherCoordinates) {
  for (const bool transform : {false, true}) {
    SCOPED_TRACE(transform);
    write_model({make_plane("Wall", 8)});
    edit_model([&](Document& document) {
      Json info = {{"index", add_texture(document, make_noise(32))}};
      if (transform) {
        info["extensions"]["KHR_texture_transform"] = {{"scale", {4, 4}}};
        document.json["extensionsUsed"] = {"KHR_texture_transform"};
      } else {
        add_uvs(document, 1, [](double u, double v) { return std::array{4 * u, 4 * v}; });
        info["texCoord"] = 1;
      }
      document.json["materials"][0]["normalTexture"] = info;
    });
    json job = job_at(0.1, 0.05);
    EXPECT_EQ(check(job)["decals"][0]["uv_conflicts"], json::array()) << "the colour alone is fine";
    job["decals"][0]["layers"] = {{"normal", "relief.png"}};
    const json conflicts = check(job)["decals"][0]["uv_conflicts"];
    ASSERT_EQ(conflicts.size(), 1u);
    EXPECT_EQ(conflicts[0]["slots"], json::array({"normal"}));

    const Model before = load("model.glb");
    const json report = bake(job);
    for (const json& texture : report["textures"]) EXPECT_EQ(texture["shared_texels"], 0) << texture;
    const Model after = load("out.glb");
    EXPECT_TRUE(is_red(colour_near(after, {0.1, 0.05, 0})));
    const Model relief_before = showing(before, normal_slot), relief = showing(after, normal_slot);
    for (const Vec3& place : {Vec3(0.1, 0.05, 0), Vec3(-0.3, 0.4, 0), Vec3(0.5, -0.3, 0)}) {
      EXPECT_NEAR(colour_near(relief, place)[0], 204, 2);
      EXPECT_NEAR(colour_near(relief, place)[2], 230, 2);
    }
    for (const Vec3& place :
         {Vec3(0.7, 0.05, 0), Vec3(-0.9, 0.4, 0), Vec3(0.1, 0.8, 0), Vec3(-0.45, -0.6, 0)})
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(colour_near(relief, place)[c], colour_near(relief_before, place)[c], 1)
            << place.transpose();
    expect_valid("out.glb");

    job["decals"][0]["opacity"] = 0;
    bake(job, "unseen.glb");
    EXPECT_LT(compare_looks(before, load("unseen.glb")).largest, 2);
    EXPECT_LT(compare_looks(relief_before, showing(load("unseen.glb"), normal_slot)).largest, 2);
  }
}

/// The colour is tiled, and the decal does not write it.
TEST_F(UvSeparationTest, ATiledSlotThatIsNotWritten) {
  write_model({make_plane("Wall", 8)});
  edit_model([&](Document& document) {
    auto& material = document.json["materials"][0];
    material["normalTexture"] = {{"index", add_texture(document, make_noise(64))}};
    material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
        {"scale", {4, 4}}};
    document.json["extensionsUsed"] = {"KHR_texture_transform"};
  });
  json job = job_at(0, 0);
  job["decals"][0]["layers"] = {{"baseColor", false}, {"normal", "relief.png"}};
  EXPECT_EQ(check(job)["decals"][0]["uv_conflicts"], json::array());
  EXPECT_EQ(bake(job)["textures"][0]["separated_triangles"], 0);
}

class SharedMeshTest : public UvSeparationTest {
 protected:
  /// The second of two nodes mirrors.
  void show_twice() {
    edit_model([](Document& document) {
      document.json["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}, {"scale", {-1, 1, 1}}});
      document.json["scenes"][0]["nodes"].push_back(1);
    });
  }
};

TEST_F(SharedMeshTest, AllInstancesWithoutCoordinates) {
  SmallMesh wall = make_plane("Wall", 8);
  wall.uvs.clear();
  write_model({wall});
  show_twice();
  for (const double x : {0.2, 5.2}) {
    SCOPED_TRACE(x);
    json job = job_at(x, 0.1);
    job["decals"][0]["instance"] = "all";
    const json report = bake(job);
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["decals"][0]["warnings"], json::array());
    const Model after = load("out.glb");
    EXPECT_EQ(after.document.json["meshes"].size(), 1u) << "the mesh is not copied";
    const double other = 5 - x;
    for (const double at : {x, other}) {
      EXPECT_TRUE(is_red(colour_near(after, {at, 0.1, 0}))) << at;
      EXPECT_TRUE(is_red(colour_near(after, {at + 0.4, -0.3, 0}))) << at;
      EXPECT_FALSE(is_red(colour_near(after, {at, 0.7, 0}))) << at;
    }
    expect_valid("out.glb");
  }
}

TEST_F(SharedMeshTest, AllInstancesOfOneFace) {
  write_model({make_box()});
  show_twice();
  const Model before = load("model.glb");
  for (const double x : {0.0, 5.0}) {
    SCOPED_TRACE(x);
    json job = job_at(x, 0);
    job["decals"][0]["instance"] = "all";
    expect_same_look(job);
    bake(job);
    const Model after = load("out.glb");
    for (const double node : {0.0, 5.0}) {
      EXPECT_TRUE(is_red(colour_near(after, {node + 0.2, 0.3, 1})));
      EXPECT_FALSE(is_red(colour_near(after, {node + 0.2, 0.3, -1})));
      EXPECT_FALSE(is_red(colour_near(after, {node + 0.2, 1, 0.3})));
    }
  }
}

TEST_F(SharedMeshTest, DecalsForAllFromBothNodes) {
  write_model({make_box()});
  show_twice();
  json job = job_at(-0.3, 0.3);
  job["decals"].push_back(job_at(5 + 0.3, -0.3)["decals"][0]);
  job["decals"][1]["name"] = "other";
  for (json& decal : job["decals"]) {
    decal["instance"] = "all";
    decal["size"] = 0.5;
  }
  expect_same_look(job);
  bake(job);
  const Model after = load("out.glb");
  for (const double node : {0.0, 5.0}) {
    const double side = node == 0 ? 1 : -1;
    EXPECT_TRUE(is_red(colour_near(after, {node - side * 0.3, 0.3, 1}))) << node;
    EXPECT_TRUE(is_red(colour_near(after, {node - side * 0.3, -0.3, 1}))) << node;
    EXPECT_FALSE(is_red(colour_near(after, {node + side * 0.3, 0.3, 1}))) << node;
    EXPECT_FALSE(is_red(colour_near(after, {node - side * 0.3, 0.3, -1}))) << node;
  }
}

TEST_F(SharedMeshTest, DecalsOfBothSortsAreToldWhatToDo) {
  write_model({make_box()});
  show_twice();
  json job = job_at(0, 0);
  job["decals"].push_back(job["decals"][0]);
  job["decals"][1].update({{"name", "everywhere"}, {"instance", "all"}});
  EXPECT_EQ(check(job, 3)["decals"][0]["uv_conflicts"][0]["outcome"], "error");
  expect_said({"\"instance\"", "'Box'", "\"share\"", "\"overlay\""});
  folder_.write("job.json", job);
  EXPECT_EQ(folder_.run("bake job.json -o out.glb").status, 3);
  for (json& decal : job["decals"]) decal["uv_conflict"] = "share";
  bake(job);
  for (json& decal : job["decals"]) decal.update({{"uv_conflict", "separate"}, {"instance", "all"}});
  bake(job);
}

class StoredTexturesTest : public UvSeparationTest {
 protected:
  void SetUp() override {
    UvSeparationTest::SetUp();
    write_model({make_box()}, 64);
    edit_model([](Document& document) {
      const std::size_t texture = add_texture(document, make_noise(64));
      auto& material = document.json["materials"][0];
      material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"] = texture;
      material["occlusionTexture"]["index"] = texture;
      material["normalTexture"] = {{"index", add_texture(document, make_noise(32))}};
      material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"] = {{"index", 0}};
      document.json["extensionsUsed"] = {"KHR_materials_clearcoat"};
    });
  }
};

TEST_F(StoredTexturesTest, AllInTheWantedFormat) {
  json job = job_at(0, 0);
  job["decals"][0]["layers"] = {{"roughness", 0.25}};  // which shares its texture with the occlusion
  for (const std::string format : {"webp", "jpeg", "png"}) {
    SCOPED_TRACE(format);
    const json report = bake(job, "out.glb", "--texture-format " + format);
    ASSERT_TRUE(report.is_object());
    const Model after = load("out.glb");
    const auto images = images_of_separated(after);
    EXPECT_EQ(images.size(), 5u);
    for (const std::size_t image : images)
      EXPECT_EQ(after.document.json["images"][image]["mimeType"], "image/" + format);
    EXPECT_EQ(report["warnings"], json::array());
  }
}

TEST_F(StoredTexturesTest, OfTheWantedQualityAndBits) {
  const json job = job_at(0, 0);
  std::uintmax_t sizes[2] = {};
  for (const int quality : {20, 95}) {
    bake(job, "out.glb", "--texture-format jpeg --texture-quality " + std::to_string(quality));
    const Model after = load("out.glb");
    for (const std::size_t image : images_of_separated(after))
      sizes[quality == 95 ? 1 : 0] += read_image_bytes(after.document, image).value().size();
  }
  EXPECT_LT(2 * sizes[0], sizes[1]);
  bake(job, "out.glb", "--texture-bits 16");
  const Model after = load("out.glb");
  for (const std::size_t image : images_of_separated(after))
    EXPECT_EQ(load_model_image(after, image).value().bits, 16);
}

TEST_F(StoredTexturesTest, TransparencyIsKeptFromJpeg) {
  edit_model([](Document& document) {
    Image image = make_noise(64);
    image.channels = 4;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 0x8080;
    document.json["materials"][0]["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]["index"] =
        add_texture(document, image);
  });
  const json report = bake(job_at(0, 0), "out.glb", "--texture-format jpeg");
  ASSERT_EQ(report["warnings"].size(), 1u);
  EXPECT_EQ(report["warnings"][0]["code"], "texture_is_png");
  EXPECT_NE(report["warnings"][0]["message"].get<std::string>().find("clearcoatTexture"), std::string::npos);
}

/// The pixels of a texture that nothing is baked into are not read: its size is in the header.
TEST_F(UvSeparationTest, ReadsTheSizeOfATextureThatItDoesNotWrite) {
  write_model({make_plane("Wall", 8)}, 48);
  edit_model([](Document& document) {
    auto& image = document.json["images"][0];
    std::vector<std::uint8_t> bytes = read_image_bytes(document, 0).value();
    bytes.resize(bytes.size() / 2);
    image["bufferView"] = add_buffer_view(document, bytes);
  });
  json job = job_at(0, 0);
  job["decals"][0]["layers"] = {{"baseColor", false}, {"normal", "relief.png"}};
  const json report = bake(job);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["textures"][0]["slot"], "normal");
  EXPECT_EQ(report["textures"][0]["width"], 48);
}

/// Materials with what cannot be resampled or has other materials beside it.
class OddMaterialsTest : public UvSeparationTest {
 protected:
  /// Adds a texture of nothing but a KTX2's header, and returns its index.
  static std::size_t add_ktx2(Document& document, std::uint8_t side) {
    std::vector<std::uint8_t> bytes = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
    bytes.resize(104, 0);
    bytes[20] = bytes[24] = side;
    const std::size_t view = add_buffer_view(document, bytes);
    document.json["images"].push_back({{"mimeType", "image/ktx2"}, {"bufferView", view}});
    document.json["textures"].push_back(
        {{"extensions", {{"KHR_texture_basisu", {{"source", document.json["images"].size() - 1}}}}}});
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
      document.json[list] = {"KHR_texture_basisu"};
    return document.json["textures"].size() - 1;
  }

  static const Json& separated_material(const Model& model) {
    return model.document
        .json["materials"]
             [model.document.json["meshes"][0]["primitives"].back()["material"].get<std::size_t>()];
  }

  /// The old coordinates of the separated triangles are there as they were, in the set that a reference has.
  void expect_old_uvs(const Model& model, const Json& reference) {
    Document document = model.document;
    for (auto& material : document.json["materials"])
      if (const SlotPointer base("/pbrMetallicRoughness/baseColorTexture"); material.contains(base))
        material[base]["texCoord"] = reference.value("texCoord", 0);
    const Model shown = decode_model(std::move(document)).value();
    ASSERT_EQ(shown.parts.size(), 2u);
    for (std::size_t i = 0; i < shown.parts[1].positions.size(); ++i) {
      const Vec3& p = shown.parts[1].positions[i];
      EXPECT_NEAR(shown.parts[1].uvs[i][0], 0.5 + 0.5 * p.x(), 1e-6);
      EXPECT_NEAR(shown.parts[1].uvs[i][1], 0.5 - 0.5 * p.y(), 1e-6);
    }
  }
};

TEST_F(OddMaterialsTest, AKtx2BesideThePaint) {
  for (const int material : {0, 1}) {
    SCOPED_TRACE(material);
    SmallMesh box = make_box();
    box.material = material;
    write_model({box});
    edit_model([&](Document& document) {
      document.json["materials"][material]["normalTexture"]["index"] = add_ktx2(document, 64);
    });
    json job = job_at(0, 0);
    const json report = bake(job);
    ASSERT_TRUE(report.is_object());
    ASSERT_EQ(report["decals"][0]["warnings"].size(), 1u);
    EXPECT_EQ(report["decals"][0]["warnings"][0]["code"], "uv_slot_not_resampled");
    EXPECT_EQ(report["textures"][0]["created"], material == 1);
    const Model after = load("out.glb");
    EXPECT_TRUE(is_red(colour_near(after, {0.2, 0.3, 1})));
    EXPECT_FALSE(is_red(colour_near(after, {0.2, 0.3, -1})));
    expect_old_uvs(after, separated_material(after)["normalTexture"]);
    job["decals"][0]["opacity"] = 0;
    bake(job, "unseen.glb");
    EXPECT_LT(compare_looks(load("model.glb"), load("unseen.glb")).largest, 2);
  }
}

TEST_F(OddMaterialsTest, AKtx2AsThePaint) {
  write_model({make_box()});
  edit_model([&](Document& document) {
    document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
        add_ktx2(document, 64);
  });
  json job = job_at(0.1, 0);
  folder_.write("job.json", job);
  for (const char* command : {"check job.json", "bake job.json -o out.glb"}) {
    const CommandResult result = folder_.run(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_NE(result.err.find("KTX"), std::string::npos) << result.err;
  }
  // A relief on it goes where the colour cannot.
  job["decals"][0]["layers"] = {{"baseColor", false}, {"normal", "relief.png"}};
  const json report = bake(job);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["decals"][0]["warnings"][0]["code"], "uv_slot_not_resampled");
  EXPECT_EQ(report["textures"][0]["slot"], "normal");
  EXPECT_EQ(report["textures"][0]["created"], true);
  const Model after = load("out.glb");
  expect_old_uvs(after, separated_material(after)["pbrMetallicRoughness"]["baseColorTexture"]);
  const Model relief = showing(after, normal_slot);
  EXPECT_NEAR(colour_near(relief, {0.2, 0.3, 1})[0], 204, 2);
  EXPECT_NEAR(colour_near(relief, {0.7, 0.3, 1})[0], 128, 2);
}

TEST_F(OddMaterialsTest, Variants) {
  for (const int material : {0, 1}) {
    SCOPED_TRACE(material);
    SmallMesh box = make_box();
    box.material = material;
    write_model({box});
    edit_model([&](Document& document) {
      auto& root = document.json;
      root["extensionsUsed"] = {"KHR_materials_variants"};
      root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "plainly"}},
                                                                  {{"name", "painted"}}};
      root["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
          {{"material", 1}, {"variants", {0}}}, {{"material", 0}, {"variants", {1}}}};
    });
    const Model before = load("model.glb");
    const json report = bake(job_at(0, 0));
    ASSERT_TRUE(report.is_object());
    ASSERT_EQ(report["decals"][0]["warnings"].size(), 1u);
    const json& warning = report["decals"][0]["warnings"][0];
    EXPECT_EQ(warning["code"], "variants_without_decal");
    const std::string message = warning["message"];
    EXPECT_EQ(message.find("'plainly'") != std::string::npos, material == 0) << message;
    EXPECT_EQ(message.find("'painted'") != std::string::npos, material == 1) << message;
    const Model after = load("out.glb");
    EXPECT_TRUE(is_red(colour_near(after, {0.2, 0.3, 1})));
    EXPECT_FALSE(is_red(colour_near(after, {0.2, 0.3, -1})));
    // The validator takes coordinates that only a variant shows for unused.
    if (material == 1) expect_valid("out.glb");
    // As a viewer shows the variants: the decal in one, the other as it was.
    for (const std::size_t variant : {0, 1}) {
      const auto choose = [&](const Model& model) {
        Document document = model.document;
        for (auto& primitive : document.json["meshes"][0]["primitives"])
          primitive["material"] =
              primitive["extensions"]["KHR_materials_variants"]["mappings"][variant]["material"];
        return decode_model(std::move(document)).value();
      };
      const bool other = (variant == 0) == (material == 0);
      EXPECT_EQ(is_red(colour_near(choose(after), {0.2, 0.3, 1})), !other);
      if (other) {
        EXPECT_LT(compare_looks(choose(before), choose(after)).largest, 1e-6);
      }
    }
  }
}

/// Triangles whose coordinates lie on a line or in a point, all of them or every other one.
TEST_F(OddMaterialsTest, CoordinatesWithoutAnArea) {
  for (const bool line : {false, true})
    for (const bool all : {false, true}) {
      SCOPED_TRACE(std::to_string(line) + std::to_string(all));
      const SmallMesh plane = make_plane("Wall", 8);
      SmallMesh wall = plane;
      wall.positions.clear();
      wall.uvs.clear();
      for (std::uint32_t t = 0; t < plane.triangles.size(); ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t vertex = plane.triangles[t][k];
          wall.positions.push_back(plane.positions[vertex]);
          wall.uvs.push_back(plane.uvs[vertex]);
          if (!all && t % 2 == 0) continue;
          wall.uvs.back()[1] = 0.3;
          if (!line) wall.uvs.back()[0] = 0.6;
        }
        wall.triangles[t] = {3 * t, 3 * t + 1, 3 * t + 2};
      }
      write_model({wall});
      const json job = job_at(0, 0);
      expect_same_look(job);
      bake(job);
      const Model after = load("out.glb");
      for (const double x : {-0.45, 0.05, 0.2, 0.45})
        for (const double y : {-0.45, 0.1, 0.4})
          EXPECT_TRUE(is_red(colour_near(after, {x, y, 0}))) << x << ", " << y;
      EXPECT_FALSE(is_red(colour_near(after, {0.6, 0.1, 0})));
      EXPECT_FALSE(is_red(colour_near(after, {0.1, 0.6, 0})));
    }
}

/// A wall with normals, whose texture coordinates are turned by 0.5 and too coarse for a decal, so that they
/// become others; of a brushed metal.
class AnisotropyTest : public UvSeparationTest {
 protected:
  void write_wall(bool normals) {
    SmallMesh wall = make_plane("Wall", 8);
    for (auto& uv : wall.uvs) {
      const double u = 0.01 * (uv[0] - 0.5), v = 0.01 * (uv[1] - 0.5);
      uv = {0.5 + std::cos(0.5) * u + std::sin(0.5) * v, 0.5 - std::sin(0.5) * u + std::cos(0.5) * v};
    }
    if (normals) wall.normals.assign(wall.positions.size(), Vec3::UnitZ());
    write_model({wall});
    edit_model([](Document& document) {
      document.json["materials"][0]["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", 0.8},
                                                                                 {"anisotropyRotation", 0.7}};
      document.json["extensionsUsed"] = {"KHR_materials_anisotropy"};
    });
  }

  static const ModelPart& separated(const Model& model) { return model.parts.back(); }

  static void expect_tangents(const Model& model, const Vec3& along) {
    ASSERT_EQ(separated(model).tangents.size(), separated(model).positions.size());
    for (const Tangent& tangent : separated(model).tangents) {
      EXPECT_LT((tangent.direction - along).norm(), 1e-3);
      EXPECT_EQ(tangent.sign, 1);
    }
  }
};

TEST_F(AnisotropyTest, KeepsItsDirection) {
  write_wall(true);
  const json report = bake(job_at(0, 0));
  ASSERT_TRUE(report.is_object());
  EXPECT_GT(report["textures"][0]["separated_triangles"], 0);
  EXPECT_EQ(report["decals"][0]["warnings"], json::array());
  const Model after = load("out.glb");
  // Along the old u, seen with y up.
  expect_tangents(after, {std::cos(0.5), -std::sin(0.5), 0});
  const auto& material = after.document.json["materials"][*separated(after).material];
  EXPECT_EQ(material["extensions"]["KHR_materials_anisotropy"]["anisotropyRotation"], 0.7);
}

TEST_F(AnisotropyTest, WithAReliefAndTangents) {
  for (const bool tangents : {false, true}) {
    SCOPED_TRACE(tangents);
    write_wall(true);
    const Vec3 along = tangents ? Vec3(0, 1, 0) : Vec3(std::cos(0.5), -std::sin(0.5), 0);
    edit_model([&](Document& document) {
      Image relief = make_image(16, 16, {204 * 257, 128 * 257, 230 * 257, 0xffff});
      relief.channels = 3;
      document.json["materials"][0]["normalTexture"]["index"] = add_texture(document, relief);
      if (!tangents) return;
      std::vector<double> values;
      for (int i = 0; i < 81; ++i) values.insert(values.end(), {0, 1, 0, 1});
      const std::size_t accessor =
          add_accessor(document, {{"componentType", 5126}, {"type", "VEC4"}}, values, 4, false, 34962);
      document.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = accessor;
    });
    bake(job_at(0, 0));
    const Model after = load("out.glb");
    expect_tangents(after, along);
    const auto normal = after.document.json["materials"][*separated(after).material]["normalTexture"]["index"]
                            .get<std::size_t>();
    const Image relief =
        load_model_image(after, after.document.json["textures"][normal]["source"].get<std::size_t>()).value();
    for (std::size_t i = 0; i < relief.rgba.size(); ++i) ASSERT_EQ(relief.rgba[i], relief.rgba[i % 4]);
    EXPECT_EQ(relief.rgba[0], 204 * 257) << "in the frames that it was made for";
  }
}

TEST_F(AnisotropyTest, WithoutNormalsIsWarnedOf) {
  write_wall(false);
  const json report = bake(job_at(0, 0));
  ASSERT_EQ(report["decals"][0]["warnings"].size(), 1u);
  EXPECT_EQ(report["decals"][0]["warnings"][0]["code"], "anisotropy_turns");
}

}  // namespace
}  // namespace applique
