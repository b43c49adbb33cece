// Overlays with material: each layer of the decal is in the overlay's own, and looks as it does baked.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "binary_edit.h"
#include "cli/sheet.h"
#include "gltf/validator.h"
#include "material.h"
#include "media_type.h"
#include "save_document.h"

namespace applique {
namespace {

using nlohmann::json;

constexpr double level = 1.01 / 255;

Image plain_image(int size, const std::array<double, 3>& colour) {
  std::array<std::uint16_t, 4> stored = {0, 0, 0, 65535};
  for (std::size_t c = 0; c < 3; ++c)
    stored[c] = static_cast<std::uint16_t>(257 * std::lround(255 * colour[c]));
  Image image = make_image(size, size, stored);
  image.channels = 3;
  return image;
}

std::array<double, 3> stored_normal(const Vec3& normal) {
  return {0.5 + 0.5 * normal.x(), 0.5 + 0.5 * normal.y(), 0.5 + 0.5 * normal.z()};
}

class OverlayLayers : public SheetTest {
 protected:
  static json overlay_job(const json& layers) {
    json job = job_at(0, 0, 0);
    job["decals"][0]["output"] = "overlay";
    job["decals"][0]["layers"] = layers;
    return job;
  }

  /// Bakes; the overlay's material.
  json bake_material(const json& job, const std::string& options = "") {
    const CommandResult result = bake(job, "-o out.glb --report report.json " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    model_ = output();
    return model_.document.json["materials"][part_named(model_, "crest").material.value()];
  }

  Image picture_of(const json& material, MaterialSlot slot) const {
    const auto texture = read_texture(model_.document, material, slot);
    EXPECT_TRUE(texture.image) << name_of(slot);
    return texture.image ? load_model_image(model_, *texture.image).value() : make_image(1, 1, {});
  }

  static double value_at(const Image& image, double u, double v, int channel) {
    return image.pixel(static_cast<int>(u * image.width), static_cast<int>(v * image.height))[channel] /
           65535.0;
  }

  /// The decal's warnings of a code.
  std::vector<std::string> warnings(const std::string& code) {
    std::vector<std::string> messages;
    const json told = report()["decals"][0]["warnings"];
    for (const auto& warning : told)
      if (warning["code"] == code) messages.push_back(warning["message"]);
    return messages;
  }

  void set_ground(const char* key, double value) {
    edit_model(
        [&](Document& document) { document.json["materials"][0]["pbrMetallicRoughness"][key] = value; });
  }

  void add_ground_texture(const char* key) {
    edit_model([&](Document& document) {
      auto& material = document.json["materials"][0];
      const bool in_pbr = std::string(key) == "metallicRoughnessTexture";
      (in_pbr ? material["pbrMetallicRoughness"] : material)[key] = {{"index", 0}};
    });
  }

  void expect_valid(const std::string& name) {
    const auto counts = validate({folder_ / name});
    if (!counts) {
      std::puts("the glTF validator is not installed (./dev test installs it)");
      return;
    }
    for (const auto& [code, count] : counts->front())
      EXPECT_GT(code.front(), '1') << name << ": " << code << " " << count;
  }

  Model model_;
};

TEST_F(OverlayLayers, AreTexturesAndFactors) {
  write_png(folder_ / "relief.png", plain_image(32, stored_normal(Vec3(0.6, 0, 0.8))));
  write_png(folder_ / "rough.png", plain_image(image_size, {0.25, 0, 0}));
  write_png(folder_ / "glow.png", plain_image(image_size, {0, 1, 0.5}));
  const json material = bake_material(overlay_job({{"normal", "relief.png"},
                                                   {"metallic", 1.0},
                                                   {"roughness", "rough.png"},
                                                   {"occlusion", 0.4},
                                                   {"emissive", "glow.png"}}));
  const Image normal = picture_of(material, MaterialSlot::normal);
  EXPECT_EQ(normal.width, image_size);
  EXPECT_NEAR(value_at(normal, 0.5, 0.5, 0), 0.8, level);
  EXPECT_NEAR(value_at(normal, 0.5, 0.5, 2), 0.9, level);
  const Image gloss = picture_of(material, MaterialSlot::metallic_roughness);
  EXPECT_NEAR(value_at(gloss, 0.5, 0.5, 1), 0.25, level);
  EXPECT_NEAR(value_at(gloss, 0.5, 0.5, 2), 1, level);
  EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 1);
  EXPECT_EQ(material["pbrMetallicRoughness"]["roughnessFactor"], 1);
  EXPECT_NEAR(value_at(picture_of(material, MaterialSlot::occlusion), 0.5, 0.5, 0), 0.4, level);
  EXPECT_NEAR(value_at(picture_of(material, MaterialSlot::emissive), 0.5, 0.5, 1), 1, level);
  EXPECT_EQ(material["emissiveFactor"], json({1, 1, 1}));
  EXPECT_EQ(material["alphaMode"], "BLEND");
  EXPECT_EQ(material["extras"]["applique"]["layers"],
            json({"baseColor", "normal", "roughness", "metallic", "occlusion", "emissive"}));
  EXPECT_EQ(report()["decals"][0]["warnings"], json::array());
  expect_valid("out.glb");
}

TEST_F(OverlayLayers, OfOneValueAreFactors) {
  const json material =
      bake_material(overlay_job({{"metallic", 0.75}, {"roughness", 0.3}, {"emissive", {0, 0.5, 1}}}));
  const auto& pbr = material["pbrMetallicRoughness"];
  EXPECT_NEAR(pbr["metallicFactor"].get<double>(), 0.75, 1e-9);
  EXPECT_NEAR(pbr["roughnessFactor"].get<double>(), 0.3, 1e-9);
  EXPECT_FALSE(pbr.contains("metallicRoughnessTexture"));
  EXPECT_NEAR(material["emissiveFactor"][1].get<double>(), 0.21404, 1e-5) << "linear light";
  EXPECT_NEAR(material["emissiveFactor"][2].get<double>(), 1, 1e-9);
  EXPECT_FALSE(material.contains("emissiveTexture"));
  EXPECT_EQ(texture_of(model_, "crest").rgba, make_quarters().rgba);
}

TEST_F(OverlayLayers, WithoutAnyItIsPlain) {
  const json material = bake_material(overlay_job(json::object()));
  EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0);
  EXPECT_EQ(material["pbrMetallicRoughness"]["roughnessFactor"], 1);
  for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture", "emissiveFactor"})
    EXPECT_FALSE(material.contains(key)) << key;
  const auto& mesh = model_.document.json["meshes"][part_named(model_, "crest").mesh];
  EXPECT_FALSE(mesh["primitives"][0]["attributes"].contains("TANGENT"));
}

TEST_F(OverlayLayers, AlphaIsTheProductOfAllThatHides) {
  Image mask = plain_image(32, {1, 1, 1});  // Of another size; its right half is grey.
  for (int y = 0; y < 32; ++y)
    for (int x = 16; x < 32; ++x)
      for (int c = 0; c < 3; ++c) mask.pixel(x, y)[c] = 128 * 257;
  write_png(folder_ / "mask.png", mask);
  json job = overlay_job({{"baseColor", {{"value", {0, 0, 1}}, {"opacity", 0.5}}}, {"roughness", 0.2}});
  job["decals"][0]["mask"] = "mask.png";
  job["decals"][0]["opacity"] = 0.8;
  job["decals"][0]["region"] = {{"contour", {{16, 16}, {48, 16}, {48, 48}, {16, 48}}}};
  const json material = bake_material(job);
  const Image base = picture_of(material, MaterialSlot::base_color);
  EXPECT_NEAR(value_at(base, 0.35, 0.5, 3), 0.4, level);
  EXPECT_NEAR(value_at(base, 0.65, 0.5, 3), 0.2, level);
  EXPECT_EQ(value_at(base, 0.1, 0.5, 3), 0) << "outside the region";
  EXPECT_NEAR(value_at(base, 0.35, 0.5, 2), 1, level);
  EXPECT_NEAR(value_at(base, 0.35, 0.5, 0), 0, level);
  EXPECT_NEAR(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.2, 1e-9);
}

TEST_F(OverlayLayers, LetTheGroundThroughAsABakeDoes) {
  set_ground("roughnessFactor", 0.4);
  write_png(folder_ / "relief.png", plain_image(image_size, stored_normal(Vec3(0.6, 0, 0.8))));
  const json material = bake_material(overlay_job({{"roughness", {{"value", 0.2}, {"opacity", 0.5}}},
                                                   {"metallic", {{"value", 0.5}, {"blend", "screen"}}},
                                                   {"normal", {{"image", "relief.png"}, {"opacity", 0.5}}}}));
  EXPECT_NEAR(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.3, 1e-9);
  EXPECT_NEAR(material["pbrMetallicRoughness"]["metallicFactor"].get<double>(), 0.5, 1e-9) << "over 0";
  const Vec3 flatter = (Vec3(0.6, 0, 0.8) + Vec3::UnitZ()).normalized();
  const Image normal = picture_of(material, MaterialSlot::normal);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(value_at(normal, 0.5, 0.5, c), stored_normal(flatter)[static_cast<std::size_t>(c)], level);
  EXPECT_EQ(report()["decals"][0]["warnings"], json::array());
}

/// An overlay needs none of the model's images; that one is gone is told all the same.
TEST_F(OverlayLayers, AnImageThatIsGoneIsWarnedOf) {
  edit_model([](Document& document) { document.json["images"][0] = {{"uri", "gone.png"}}; });
  bake_material(overlay_job({{"roughness", 0.3}}));
  const json warnings = report()["warnings"];
  ASSERT_EQ(warnings.size(), 1u) << warnings;
  EXPECT_EQ(warnings[0]["code"], "file_missing");
  EXPECT_NE(warnings[0]["message"].get<std::string>().find("gone.png"), std::string::npos);
}

TEST_F(OverlayLayers, AGroundThatIsNotOneValueIsWarnedOf) {
  add_ground_texture("metallicRoughnessTexture");
  add_ground_texture("normalTexture");
  write_png(folder_ / "relief.png", plain_image(image_size, stored_normal(Vec3(0.6, 0, 0.8))));
  const json material = bake_material(overlay_job({{"roughness", {{"value", 0.2}, {"opacity", 0.5}}},
                                                   {"metallic", {{"value", 0.5}, {"blend", "multiply"}}},
                                                   {"normal", {{"image", "relief.png"}, {"blend", "add"}}}}));
  EXPECT_NEAR(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.6, 1e-9) << "over 1";
  EXPECT_NEAR(material["pbrMetallicRoughness"]["metallicFactor"].get<double>(), 0.5, 1e-9) << "as by normal";
  const auto ground = warnings("overlay_ground_unknown");
  ASSERT_EQ(ground.size(), 1u);
  EXPECT_NE(ground[0].find("'crest': its roughness lets through"), std::string::npos) << ground[0];
  const auto blends = warnings("blend_ignored");
  ASSERT_EQ(blends.size(), 2u);
  EXPECT_NE(blends[0].find("'crest': the blend mode \"multiply\" of its metallic"), std::string::npos)
      << blends[0];
  EXPECT_NE(blends[1].find("\"add\" of its normal"), std::string::npos) << blends[1];
}

TEST_F(OverlayLayers, ATransparentLayerIsWarnedOfWhereItIsSeen) {
  add_ground_texture("metallicRoughnessTexture");
  Image gloss = plain_image(image_size, {0.25, 0, 0});
  gloss.channels = 4;
  for (int y = 0; y < image_size; ++y)
    for (int x = 0; x < image_size / 2; ++x) gloss.pixel(x, y)[3] = 0;
  write_png(folder_ / "gloss.png", gloss);
  json job = overlay_job({{"roughness", "gloss.png"}});
  bake_material(job);
  EXPECT_EQ(warnings("overlay_ground_unknown").size(), 1u);
  // Where the mask hides the decal, nothing is let through.
  Image mask = gloss;
  for (std::size_t i = 0; i < mask.rgba.size(); i += 4)
    mask.rgba[i] = mask.rgba[i + 1] = mask.rgba[i + 2] = 65535;
  write_png(folder_ / "mask.png", mask);
  job["decals"][0]["mask"] = "mask.png";
  bake_material(job);
  EXPECT_TRUE(warnings("overlay_ground_unknown").empty());
}

TEST_F(OverlayLayers, BlendModesOfTheColourAreWarnedOf) {
  for (const std::string mode : {"multiply", "erase", "luminosity"}) {
    json job = overlay_job(json::object());
    job["decals"][0]["blend"] = mode;
    bake_material(job);
    const auto blends = warnings("blend_ignored");
    ASSERT_EQ(blends.size(), 1u) << mode;
    EXPECT_NE(blends[0].find("'crest'"), std::string::npos) << blends[0];
    EXPECT_NE(blends[0].find("\"" + mode + "\" of its baseColor"), std::string::npos) << blends[0];
    EXPECT_EQ(texture_of(model_, "crest").rgba, make_quarters().rgba);
    job["decals"][0]["output"] = "bake";
    ASSERT_EQ(bake(job).status, 0);
    EXPECT_TRUE(warnings("blend_ignored").empty()) << mode;
  }
}

TEST_F(OverlayLayers, AreEncodedAsAsked) {
  write_png(folder_ / "relief.png", plain_image(image_size, stored_normal(Vec3(0.6, 0, 0.8))));
  write_png(folder_ / "glow.png", make_quarters());
  const json job = overlay_job(
      {{"normal", "relief.png"}, {"roughness", "glow.png"}, {"occlusion", 0.4}, {"emissive", "glow.png"}});
  struct Case {
    const char* options;
    const char* media_type;
    int bits;
  };
  for (const Case& wanted : {Case{"", "image/png", 8}, Case{"--texture-bits 16", "image/png", 16},
                             Case{"--texture-format jpeg --texture-quality 95", "image/jpeg", 8},
                             Case{"--texture-format webp --texture-quality 100", "image/webp", 8}}) {
    SCOPED_TRACE(wanted.options);
    const json material = bake_material(job, wanted.options);
    for (const MaterialSlot slot : all_slots) {
      const auto texture = read_texture(model_.document, material, slot);
      ASSERT_TRUE(texture.image) << name_of(slot);
      EXPECT_EQ(media_type_of(read_image_bytes(model_.document, *texture.image).value()), wanted.media_type)
          << name_of(slot);
      EXPECT_EQ(load_model_image(model_, *texture.image)->bits, wanted.bits) << name_of(slot);
    }
    expect_valid("out.glb");
  }
  ASSERT_EQ(bake(job, "-o out.gltf --report report.json --texture-format webp").status, 0);
  expect_valid("out.gltf");
  // What is transparent stays a PNG, and its slot is named.
  json half = job;
  half["decals"][0]["opacity"] = 0.5;
  ASSERT_EQ(bake(half, "-o out.glb --report report.json --texture-format jpeg").status, 0);
  const json told = report()["warnings"];
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0]["code"], "texture_is_png");
  EXPECT_NE(told[0]["message"].get<std::string>().find("baseColor texture of the overlay 'crest'"),
            std::string::npos);
}

/// The direction in which a viewer sees a normal map's vector: along the texture's u, and against its v,
/// which points down.
Vec3 shown_normal(const ModelPart& part, std::size_t triangle, const Vec3& stored) {
  const auto& t = part.triangles[triangle];
  Eigen::Matrix2d uv;
  Eigen::Matrix<double, 3, 2> xyz;
  for (int k = 0; k < 2; ++k) {
    const auto &from = part.uvs[t[0]], &to = part.uvs[t[static_cast<std::size_t>(k) + 1]];
    uv.col(k) << to[0] - from[0], to[1] - from[1];
    xyz.col(k) = part.positions[t[static_cast<std::size_t>(k) + 1]] - part.positions[t[0]];
  }
  const Eigen::Matrix<double, 3, 2> by_uv = xyz * uv.inverse();
  const Vec3 tangent = by_uv.col(0).normalized(), bitangent = -by_uv.col(1).normalized();
  if (!part.tangents.empty()) {
    const auto& [direction, sign] = part.tangents[t[0]];
    EXPECT_LT((direction - tangent).norm(), 1e-3);
    EXPECT_LT((sign * part.normals[t[0]].cross(direction) - bitangent).norm(), 1e-3);
  }
  return stored.x() * tangent + stored.y() * bitangent + stored.z() * part.normals[t[0]];
}

TEST_F(OverlayLayers, NormalsLieWithTheImage) {
  const Vec3 relief = Vec3(0.5, 0.2, 0.8).normalized();
  write_png(folder_ / "relief.png", plain_image(image_size, stored_normal(relief)));
  for (const bool node_mirrored : {false, true}) {
    for (const bool mirrored : {false, true}) {
      for (const double turn : {0.0, 0.6, -2.0}) {
        SCOPED_TRACE(testing::Message() << node_mirrored << ", " << mirrored << ", " << turn);
        edit_model([&](Document& document) {
          document.json["nodes"][0]["scale"] = {node_mirrored ? -1 : 1, 1, 1};
        });
        const Vec3 along(std::cos(turn), std::sin(turn), 0);
        json job = overlay_job({{"normal", "relief.png"}});
        auto& decal = job["decals"][0];
        decal["mirrored"] = mirrored;
        for (const int k : {0, 1}) {
          const Vec3 place = (k == 0 ? -0.25 : 0.25) * along;
          decal["features"][k]["position"] = {place.x(), place.y(), 0};
        }
        const json material = bake_material(job);
        const Image normal = picture_of(material, MaterialSlot::normal);
        Vec3 stored;
        for (int c = 0; c < 3; ++c) stored[c] = 2 * value_at(normal, 0.5, 0.5, c) - 1;
        const ModelPart& part = part_named(model_, "crest");
        EXPECT_FALSE(part.tangents.empty());
        EXPECT_FALSE(part.mirrored);
        const Vec3 up = (mirrored ? -1 : 1) * Vec3::UnitZ().cross(along);
        const Vec3 expected = relief.x() * along + relief.y() * up + relief.z() * Vec3::UnitZ();
        for (std::size_t t = 0; t < part.triangles.size(); ++t) {
          EXPECT_LT((shown_normal(part, t, stored) - expected).norm(), 0.02);
        }
        expect_valid("out.glb");
      }
    }
  }
}

TEST_F(OverlayLayers, NormalMapsWithoutDirectionsAreNamed) {
  for (const char* output : {"bake", "overlay"}) {
    SCOPED_TRACE(output);
    json job = overlay_job({{"normal", "relief.png"}});
    job["decals"][0]["output"] = output;
    std::filesystem::remove(folder_ / "out.glb");
    for (const double grey : {0.0, 128.0 / 255}) {
      write_png(folder_ / "relief.png", plain_image(image_size, {grey, grey, grey}));
      const CommandResult result = bake(job);
      EXPECT_EQ(result.status, 2);
      EXPECT_NE(result.err.find("decal 'crest': 'relief.png' is no normal map"), std::string::npos)
          << result.err;
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out.glb"));
    }
    Image part = plain_image(image_size, stored_normal(Vec3(0.6, 0, 0.8)));
    for (int y = 0; y < image_size / 4; ++y)
      for (int x = 0; x < image_size; ++x)
        part.pixel(x, y)[0] = part.pixel(x, y)[1] = part.pixel(x, y)[2] = 0;
    write_png(folder_ / "relief.png", part);
    ASSERT_EQ(bake(job).status, 0);
    const auto told = warnings("normal_map_faulty");
    ASSERT_EQ(told.size(), 1u);
    EXPECT_NE(told[0].find("'crest': 25 % of the pixels of 'relief.png'"), std::string::npos) << told[0];
    // Those pixels are flat. The image's upper quarter lies at y 0.25 to 0.5, at v 0.25 to 0.375.
    model_ = this->output();
    const bool baked = std::string(output) == "bake";
    const json material =
        model_.document.json["materials"][part_named(model_, baked ? "Sheet" : "crest").material.value()];
    const Image normal = picture_of(material, MaterialSlot::normal);
    EXPECT_NEAR(value_at(normal, 0.5, baked ? 0.3 : 0.1, 0), 128.0 / 255, level);
    EXPECT_NEAR(value_at(normal, 0.5, baked ? 0.3 : 0.1, 2), 1, level);
    EXPECT_NEAR(value_at(normal, 0.5, 0.5, 0), 0.8, level);
  }
}

/// A decal of all layers on a smooth hill, bent so that no similarity fits.
class OverlayLook : public OverlayLayers {
 protected:
  static constexpr int size = 256;

  void write_hill(int cells) {
    SmallMesh hill = make_plane("Hill", cells);
    for (Vec3& p : hill.positions) {
      const double height = 0.5 * std::exp(-p.squaredNorm());
      hill.normals.push_back(Vec3(2 * height * p.x(), 2 * height * p.y(), 1).normalized());
      p.z() = height;
    }
    write_small_model(folder_ / "model.glb", {hill},
                      {{"paint", plain_image(512, {0.7, 0.7, 0.7}), {1, 1, 1, 1}}});
  }

  void SetUp() override {
    Image image = plain_image(size, {0, 0.4, 0.6}), relief = image, gloss = image, glow = image;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double u = (x + 0.5) / size, v = (y + 0.5) / size, turn = 2 * std::numbers::pi;
        image.pixel(x, y)[0] = static_cast<std::uint16_t>(257 * std::lround(255 * u));
        const Vec3 n = Vec3(0.5 * std::sin(3 * turn * u), 0.3 * std::sin(2 * turn * v) + 0.2, 1).normalized();
        for (std::size_t c = 0; c < 3; ++c)
          relief.pixel(x, y)[c] = static_cast<std::uint16_t>(257 * std::lround(255 * stored_normal(n)[c]));
        for (int c = 0; c < 3; ++c) {
          gloss.pixel(x, y)[c] = static_cast<std::uint16_t>(257 * std::lround(80 + 100 * v));
          glow.pixel(x, y)[c] = static_cast<std::uint16_t>(257 * std::lround(100 * u * v));
        }
      }
    write_png(folder_ / "image.png", image);
    write_png(folder_ / "relief.png", relief);
    write_png(folder_ / "gloss.png", gloss);
    write_png(folder_ / "glow.png", glow);
  }

  /// Moves the hill by a skin of one joint.
  void add_skin() {
    edit_model([](Document& document) {
      auto& gltf = document.json;
      auto& attributes = gltf["meshes"][0]["primitives"][0]["attributes"];
      const auto count =
          gltf["accessors"][attributes["POSITION"].get<std::size_t>()]["count"].get<std::size_t>();
      std::vector<std::uint8_t> joints(4 * count, 0), bytes(16 * count, 0);
      const float one = 1;
      for (std::size_t v = 0; v < count; ++v)
        std::copy_n(reinterpret_cast<const std::uint8_t*>(&one), 4, &bytes[16 * v]);
      const auto add = [&](const std::vector<std::uint8_t>& data, int type) {
        const std::size_t view = add_buffer_view(document, data);
        gltf["accessors"].push_back(
            {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", "VEC4"}});
        return gltf["accessors"].size() - 1;
      };
      attributes["JOINTS_0"] = add(joints, 5121);
      attributes["WEIGHTS_0"] = add(bytes, 5126);
      gltf["nodes"].push_back({{"name", "joint"}});
      gltf["scenes"][0]["nodes"].push_back(1);
      gltf["skins"] = {{{"joints", {1}}}};
      gltf["nodes"][0]["skin"] = 0;
    });
  }

  Image preview(const char* output, bool mirrored, const json& layers) {
    const auto pin = [&](double x, double y, double px, double py) {
      px *= mirrored ? -1 : 1;
      return json(
          {{"image", {x * size, y * size}}, {"position", {px, py, 0.5 * std::exp(-px * px - py * py)}}});
    };
    json job = {{"version", 1},
                {"model", "model.glb"},
                {"resolution", 512},
                {"decals",
                 {{{"name", "crest"},
                   {"image", "image.png"},
                   {"output", output},
                   {"energy", "conformal"},
                   {"mirrored", mirrored},
                   {"layers", layers},
                   {"features",
                    {pin(0.25, 0.25, -0.5, 0.4), pin(0.75, 0.25, 0.45, 0.35), pin(0.5, 0.5, 0.08, -0.03),
                     pin(0.25, 0.75, -0.4, -0.4), pin(0.75, 0.75, 0.4, -0.5)}}}}}};
    const CommandResult result = bake(job, "-o out.glb --preview preview.png --report report.json");
    EXPECT_EQ(result.status, 0) << result.err;
    return read_image(folder_ / "preview.png").value();
  }

  /// In the pictures' middle, which the decal covers: of 255, the mean difference and the largest.
  static std::array<double, 2> difference(const Image& a, const Image& b) {
    double sum = 0, largest = 0;
    int count = 0;
    for (int y = a.height / 4; y < 3 * a.height / 4; ++y)
      for (int x = 3 * a.width / 8; x < 5 * a.width / 8; ++x)
        for (int c = 0; c < 3; ++c, ++count) {
          const double off = std::abs(double(a.pixel(x, y)[c]) - b.pixel(x, y)[c]) / 257;
          sum += off;
          largest = std::max(largest, off);
        }
    return {sum / count, largest};
  }
};

TEST_F(OverlayLook, IsThatOfABake) {
  const json layers = {
      {"normal", "relief.png"}, {"metallic", 0.3}, {"roughness", "gloss.png"}, {"emissive", "glow.png"}};
  struct Case {
    int cells;
    bool skin, node_mirrored, mirrored;
  };
  // On a skin of large triangles it is the pictures that are bent.
  for (const auto& [cells, skin, node_mirrored, mirrored] :
       {Case{40, false, false, false}, Case{40, false, false, true}, Case{40, false, true, false},
        Case{10, true, false, false}, Case{10, true, false, true}}) {
    SCOPED_TRACE(testing::Message() << cells << ", skin " << skin << ", node mirrored " << node_mirrored
                                    << ", mirrored " << mirrored);
    write_hill(cells);
    if (skin) add_skin();
    if (node_mirrored)
      edit_model([](Document& document) { document.json["nodes"][0]["scale"] = {-1, 1, 1}; });
    const Image baked = preview("bake", mirrored, layers);
    const json meshes = load_document(folder_ / "out.glb").value().json["meshes"];
    EXPECT_EQ(meshes[0]["primitives"][0]["attributes"].contains("TANGENT"), !node_mirrored)
        << "viewers do not agree on their sign";
    const Image overlaid = preview("overlay", mirrored, layers);
    expect_valid("out.glb");
    EXPECT_EQ(texture_of(output(), "crest").width > 2 * size, skin) << "bent, and finer for it";
    const auto [mean, largest] = difference(baked, overlaid);
    // A bake turns relief face by face: large ones show at its highlights. Unturned, the mean would be 1.
    EXPECT_LT(mean, skin ? 0.7 : 0.3);
    EXPECT_LT(largest, skin ? 10 : 4);
    RecordProperty("mean", std::to_string(mean));
    RecordProperty("largest", std::to_string(largest));
    if (skin || mirrored) continue;  // Every layer is seen: twice is enough.
    for (const char* left_out : {"normal", "metallic", "emissive"}) {
      json fewer = layers;
      fewer.erase(left_out);
      EXPECT_GT(difference(baked, preview("overlay", mirrored, fewer))[0], 2) << left_out;
    }
  }
}

}  // namespace
}  // namespace applique
