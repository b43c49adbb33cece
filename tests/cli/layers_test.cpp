// Decals with material: what is baked into the other textures than the base colour.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "material.h"
#include "model.h"
#include "save_document.h"

using namespace applique;
using nlohmann::json;

namespace {

constexpr int image_size = 64;
constexpr int texture_size = 256;

Image plain_image(std::array<double, 3> colour) {
  std::array<std::uint16_t, 4> stored = {0, 0, 0, 65535};
  for (std::size_t c = 0; c < 3; ++c)
    stored[c] = static_cast<std::uint16_t>(257 * std::lround(255 * colour[c]));
  Image image = make_image(image_size, image_size, stored);
  image.channels = 3;
  return image;
}

/// A plane with the image over its middle half, the image's x along `turn` radians from the plane's.
class LayersTest : public testing::Test {
 protected:
  using UvMap = std::function<std::array<double, 2>(const std::array<double, 2>&)>;

  void SetUp() override { write_png(folder_ / "image.png", plain_image({1, 0, 0})); }

  void write_model(const UvMap& map = {}, std::optional<Image> texture = make_noise(texture_size)) {
    SmallMesh plane = make_plane("Plane", 8);
    for (auto& uv : plane.uvs)
      if (map) uv = map(uv);
    write_small_model(folder_ / "model.glb", {plane}, {{"paint", std::move(texture), {1, 1, 1, 1}}});
  }

  static json job(const json& layers, double turn = 0) {
    const double x = 0.25 * std::cos(turn), y = 0.25 * std::sin(turn);
    return {{"version", 1},
            {"model", "model.glb"},
            {"texture_size", texture_size},
            {"decals", json::array({{{"name", "crest"},
                                     {"image", "image.png"},
                                     {"layers", layers},
                                     {"features",
                                      {{{"image", {16, 32}}, {"position", {-x, -y, 0}}},
                                       {{"image", {48, 32}}, {"position", {x, y, 0}}}}}}})}};
  }

  /// Bakes; the output, or none after a failure.
  std::optional<Model> bake(const json& job) {
    folder_.write("job.json", job);
    last_ = folder_.run("bake job.json -o out.glb --report report.json");
    EXPECT_EQ(last_.status, 0) << last_.err;
    auto model = load_model(folder_ / "out.glb");
    EXPECT_TRUE(model) << model.error().message;
    if (!model) return std::nullopt;
    return std::move(*model);
  }

  static Image image_of(const Model& model, MaterialSlot slot) {
    const auto texture = read_texture(model.document, model.document.json["materials"][0], slot);
    EXPECT_TRUE(texture.image) << name_of(slot);
    return texture.image ? load_model_image(model, *texture.image).value() : make_image(1, 1, {});
  }

  static double value_at(const Image& image, double u, double v, int channel) {
    return image.pixel(static_cast<int>(u * image.width), static_cast<int>(v * image.height))[channel] /
           65535.0;
  }

  json warnings() { return json::parse(folder_.read("report.json"))["decals"][0]["warnings"]; }

  CommandFolder folder_;
  CommandResult last_;
};

constexpr double level = 1.01 / 255;

TEST_F(LayersTest, NormalsTurnWithTheImageWhateverTheTexturesFrame) {
  // Tilted along the image's x, and a little along its y.
  const Vec3 relief = Vec3(0.5, 0.2, 0.8).normalized();
  write_png(folder_ / "normal.png",
            plain_image({0.5 + 0.5 * relief.x(), 0.5 + 0.5 * relief.y(), 0.5 + 0.5 * relief.z()}));
  for (const bool mirrored : {false, true}) {
    for (const double uv_turn : {0.0, 0.6, 2.5}) {
      for (const double turn : {0.0, -2.0}) {
        SCOPED_TRACE(testing::Message() << mirrored << ", " << uv_turn << ", " << turn);
        const double c = 0.5 * std::cos(uv_turn), s = 0.5 * std::sin(uv_turn);
        write_model([&](const auto& uv) {
          const double x = mirrored ? 0.5 - uv[0] : uv[0] - 0.5, y = uv[1] - 0.5;
          return std::array<double, 2>{0.5 + c * x - s * y, 0.5 + s * x + c * y};
        });
        const auto model = bake(job({{"normal", "normal.png"}}, turn));
        ASSERT_TRUE(model);
        const Image image = image_of(*model, MaterialSlot::normal);
        Vec3 stored;
        for (int k = 0; k < 3; ++k) stored[k] = 2 * value_at(image, 0.5, 0.5, k) - 1;
        // What a viewer makes of it: along the texture's u, and against its v, which points down.
        const ModelPart& part = model->parts[0];
        const auto& t = part.triangles[0];
        Eigen::Matrix2d uv, xy;
        for (int k = 0; k < 2; ++k) {
          uv.col(k) << part.uvs[t[k + 1]][0] - part.uvs[t[0]][0], part.uvs[t[k + 1]][1] - part.uvs[t[0]][1];
          xy.col(k) = (part.positions[t[k + 1]] - part.positions[t[0]]).head<2>();
        }
        const Eigen::Matrix2d by_uv = xy * uv.inverse();
        const Eigen::Vector2d tangent = by_uv.col(0).normalized(), bitangent = -by_uv.col(1).normalized();
        const Eigen::Vector2d shown = stored.x() * tangent + stored.y() * bitangent;
        const Eigen::Vector2d along(std::cos(turn), std::sin(turn)), up(-std::sin(turn), std::cos(turn));
        EXPECT_NEAR(shown.x(), (relief.x() * along + relief.y() * up).x(), 0.02);
        EXPECT_NEAR(shown.y(), (relief.x() * along + relief.y() * up).y(), 0.02);
        EXPECT_NEAR(stored.z(), relief.z(), 0.02);
        // Beside the decal the relief is flat, and says so exactly.
        EXPECT_EQ(image.pixel(2, 2)[0], 128 * 257);
        EXPECT_EQ(image.pixel(2, 2)[2], 65535);
      }
    }
  }
}

TEST_F(LayersTest, EachChannelGoesIntoItsTexture) {
  write_model();
  const auto model = bake(job({{"metallic", 1.0},
                               {"roughness", {{"value", 0.2}, {"opacity", 0.5}}},
                               {"occlusion", 0.4},
                               {"emissive", {0, 1, 0}},
                               {"baseColor", {0, 0, 1}}}));
  ASSERT_TRUE(model);
  const Image orm = image_of(*model, MaterialSlot::metallic_roughness);
  EXPECT_EQ(orm.width, texture_size);  // As the base colour.
  EXPECT_NEAR(value_at(orm, 0.5, 0.5, 2), 1, level);
  // write_small_model's materials have no factors: metallic 1, roughness 1.
  EXPECT_NEAR(value_at(orm, 0.5, 0.5, 1), 0.5 * 1 + 0.5 * 0.2, level);
  EXPECT_NEAR(value_at(orm, 0.05, 0.05, 1), 1, level);
  EXPECT_NEAR(value_at(image_of(*model, MaterialSlot::occlusion), 0.5, 0.5, 0), 0.4, level);
  const Image emissive = image_of(*model, MaterialSlot::emissive);
  EXPECT_NEAR(value_at(emissive, 0.5, 0.5, 1), 1, level);
  EXPECT_NEAR(value_at(emissive, 0.05, 0.05, 1), 0, level);
  const auto& material = model->document.json["materials"][0];
  EXPECT_EQ(material["emissiveFactor"], json({1, 1, 1}));
  const Image base = image_of(*model, MaterialSlot::base_color);
  EXPECT_NEAR(value_at(base, 0.5, 0.5, 2), 1, level);
  EXPECT_NEAR(value_at(base, 0.5, 0.5, 0), 0, level);
  EXPECT_TRUE(warnings().empty()) << warnings();
}

TEST_F(LayersTest, WithoutABaseColourThatTextureStaysAsItIs) {
  write_model();
  const auto before = load_model(folder_ / "model.glb").value();
  const auto model = bake(job({{"baseColor", false}, {"roughness", 0.0}}));
  ASSERT_TRUE(model);
  EXPECT_EQ(image_of(*model, MaterialSlot::base_color).rgba, image_of(before, MaterialSlot::base_color).rgba);
  EXPECT_NEAR(value_at(image_of(*model, MaterialSlot::metallic_roughness), 0.5, 0.5, 1), 0, level);
}

TEST_F(LayersTest, AMaskHoldsForAllLayers) {
  write_model();
  Image mask = make_image(32, 32, {0, 0, 0, 65535});  // Of another size than the image; its left half shows.
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 16; ++x)
      for (int c = 0; c < 3; ++c) mask.pixel(x, y)[c] = 65535;
  write_png(folder_ / "mask.png", mask);
  json masked = job({{"roughness", 0.0}});
  masked["decals"][0]["mask"] = "mask.png";
  const auto before = load_model(folder_ / "model.glb").value();
  const auto model = bake(masked);
  ASSERT_TRUE(model);
  const Image orm = image_of(*model, MaterialSlot::metallic_roughness);
  EXPECT_NEAR(value_at(orm, 0.4, 0.5, 1), 0, level);
  EXPECT_NEAR(value_at(orm, 0.6, 0.5, 1), 1, level);
  const Image base = image_of(*model, MaterialSlot::base_color);
  EXPECT_NEAR(value_at(base, 0.4, 0.5, 0), 1, level);
  EXPECT_EQ(value_at(base, 0.6, 0.5, 0), value_at(image_of(before, MaterialSlot::base_color), 0.6, 0.5, 0));
}

TEST_F(LayersTest, NewTexturesHaveTheResolutionThatTheJobNames) {
  write_model();
  json large = job({{"roughness", 0.0}});
  large["resolution"] = 512;
  const auto model = bake(large);
  ASSERT_TRUE(model);
  EXPECT_EQ(image_of(*model, MaterialSlot::metallic_roughness).width, 512);
  EXPECT_EQ(image_of(*model, MaterialSlot::base_color).width, texture_size);
}

TEST_F(LayersTest, WhatIsNotSeenIsWarnedOf) {
  write_model();
  Image clear = make_image(image_size, image_size, {65535, 0, 0, 0});
  write_png(folder_ / "clear.png", clear);
  for (int x = 0; x < 4; ++x) clear.pixel(x, 0)[3] = 65535;
  write_png(folder_ / "corner.png", clear);
  write_png(folder_ / "black.png", make_image(8, 8, {0, 0, 0, 65535}));
  const auto expect_warning = [&](const json& changes, const std::vector<std::string>& parts) {
    for (const char* output : {"bake", "overlay"}) {
      SCOPED_TRACE(testing::Message() << changes << ", " << output);
      json unseen = job(json::object());
      unseen["decals"][0].update(changes);
      unseen["decals"][0]["output"] = output;
      folder_.write("job.json", unseen);
      for (const char* command : {"check job.json", "bake job.json -o out.glb"}) {
        const CommandResult result = folder_.run(std::string(command) + " --report report.json");
        ASSERT_EQ(result.status, 0) << result.err;
        std::size_t told = 0;
        for (const json& warning : warnings()) {
          if (warning["code"] != "invisible") continue;
          ++told;
          for (const std::string& part : parts)
            EXPECT_NE(warning["message"].get<std::string>().find(part), std::string::npos) << warning;
        }
        EXPECT_EQ(told, parts.empty() ? 0u : 1u) << command << warnings();
      }
    }
  };
  const json middle = {{"contour", {{8, 8}, {56, 8}, {56, 56}, {8, 56}}}};
  expect_warning({{"opacity", 0}}, {"decal 'crest': nothing of it is seen", "\"opacity\" is 0"});
  expect_warning({{"image", "clear.png"}, {"region", {{"rectangle", true}}}}, {"'clear.png' is transparent"});
  expect_warning({{"image", "corner.png"}, {"region", middle}}, {"'corner.png' is transparent"});
  expect_warning({{"image", "corner.png"}, {"region", {{"rectangle", true}}}}, {});
  expect_warning({{"image", "clear.png"}, {"region", middle}, {"mask", "image.png"}}, {});
  expect_warning({{"mask", "black.png"}}, {"mask 'black.png' is black"});
  expect_warning({{"layers", {{"roughness", {{"value", 0}, {"opacity", 0}}}}}},
                 {"decal 'crest': layer \"roughness\": nothing of it is seen", "\"opacity\" is 0"});
  expect_warning({{"layers", {{"roughness", "clear.png"}}}},
                 {"layer \"roughness\"", "its image 'clear.png' is transparent all over"});
  expect_warning({{"layers", {{"baseColor", {{"value", {0, 0, 0}}, {"opacity", 0}}}}}},
                 {"nothing of it is seen", "\"opacity\" is 0"});
  EXPECT_EQ(warnings()[0]["message"],
            "decal 'crest': nothing of it is seen, because its base colour's \"opacity\" is 0")
      << "of an overlay, by whose base colour all is seen";
}

/// The most that two pictures differ, of 255.
double difference(const Image& a, const Image& b) {
  double largest = a.rgba.size() == b.rgba.size() ? 0 : 255;
  for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
    largest = std::max(largest, std::abs(double(a.rgba[i]) - b.rgba[i]) / 257);
  return largest;
}

TEST_F(LayersTest, WhatTheFactorsSayAlreadyIsNotSeen) {
  const auto picture = [&](const std::string& model) {
    const CommandResult result =
        folder_.run("render " + model + " -o picture.png --azimuth 30 --elevation 20");
    EXPECT_EQ(result.status, 0) << result.err;
    return read_image(folder_ / "picture.png").value();
  };
  std::vector<Image> seen;
  // Multiples of 1/255, which a texture stores exactly; none: glTF's defaults.
  for (const auto& [metallic, roughness] : {std::pair<json, json>{0, 0.4}, {0.6, 0.2}, {json(), json()}}) {
    SCOPED_TRACE(metallic.dump() + ", " + roughness.dump());
    write_model({}, plain_image({0.6, 0.4, 0.2}));
    Document document = load_document(folder_ / "model.glb").value();
    auto& pbr = document.json["materials"][0]["pbrMetallicRoughness"];
    pbr.erase("metallicFactor");
    if (!metallic.is_null()) pbr.update({{"metallicFactor", metallic}, {"roughnessFactor", roughness}});
    ASSERT_TRUE(save_document(document, folder_ / "model.glb"));
    seen.push_back(picture("model.glb"));
    ASSERT_TRUE(bake(job({{"baseColor", false},
                          {"metallic", metallic.is_null() ? json(1.0) : metallic},
                          {"roughness", roughness.is_null() ? json(1.0) : roughness}})));
    EXPECT_LE(difference(seen.back(), picture("out.glb")), 1);
    const double other = metallic == json(0) ? 1 : 0;
    ASSERT_TRUE(bake(job({{"baseColor", false}, {"metallic", other}, {"roughness", 0.2}})));
    EXPECT_GT(difference(seen.back(), picture("out.glb")), 10) << "others are seen";
  }
  EXPECT_GT(difference(seen[0], seen[1]), 10);
  EXPECT_GT(difference(seen[1], seen[2]), 10);
}

TEST_F(LayersTest, WrongLayersAreNamed) {
  write_model();
  const auto message = [&](const json& layers) {
    folder_.write("job.json", job(layers));
    const CommandResult result = folder_.run("bake job.json -o out.glb");
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  EXPECT_NE(message({{"shine", 1}}).find("/decals/0/layers: found the unknown property 'shine'"),
            std::string::npos);
  EXPECT_NE(message({{"roughness", 2}}).find("/decals/0/layers/roughness: found 2"), std::string::npos);
  EXPECT_NE(message({{"roughness", {{"value", 2}}}}).find("/decals/0/layers/roughness/value: found 2"),
            std::string::npos);
  EXPECT_NE(
      message({{"normal", {{"image", "n.png"}, {"blend", "hue"}}}}).find("/decals/0/layers/normal/blend"),
      std::string::npos);
  EXPECT_NE(message({{"metallicRoughness", "a.png"}, {"metallic", 1}}).find("which has it already"),
            std::string::npos);
  EXPECT_NE(message({{"emissive", "missing.png"}}).find("decal 'crest'"), std::string::npos);
  EXPECT_NE(message({{"emissive", "missing.png"}}).find("missing.png"), std::string::npos);
}

}  // namespace
