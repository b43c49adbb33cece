// Textures in and out: what a bake reads, how it stores what it writes.

#include <cmath>
#include <fstream>

#include <OpenImageIO/imageio.h>

#include "cli/sheet.h"
#include "edit.h"
#include "gltf/test_models.h"
#include "gltf/validator.h"
#include "media_type.h"
#include "texture_encoding.h"

namespace applique {
namespace {

using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

void write_bytes(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

class TextureFormats : public SheetTest {
 protected:
  /// The bytes that the only material's base colour is stored as.
  static Bytes stored_texture(const Model& model) {
    return read_image_bytes(model.document, model.materials.at(0).image.value()).value();
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

  /// A texture with transparency at its border, where the decal is not.
  static Image with_transparency() {
    Image texture = make_noise(texture_size);
    texture.channels = 4;
    for (int x = 0; x < texture_size; ++x) texture.pixel(x, 0)[3] = 257 * 100;
    return texture;
  }
};

TEST_F(TextureFormats, StoresWhatIsAskedFor) {
  struct Case {
    const char* options;
    const char* media_type;
    int bits;
    int tolerance;
  };
  for (const Case& wanted : {Case{"", "image/png", 8, 0}, Case{"--texture-bits 16", "image/png", 16, 0},
                             Case{"--texture-format jpeg --texture-quality 95", "image/jpeg", 8, 12},
                             Case{"--texture-format webp --texture-quality 100", "image/webp", 8, 0},
                             Case{"--texture-format webp", "image/webp", 8, 60}})
    for (const std::string name : {"out.glb", "out.gltf"}) {
      SCOPED_TRACE(name + " " + wanted.options);
      const CommandResult result =
          bake(job_at(0, 0, 0), "-o " + name + " --report report.json " + wanted.options);
      ASSERT_EQ(result.status, 0) << result.err;
      const Model model = output(name);
      EXPECT_EQ(media_type_of(stored_texture(model)), wanted.media_type);
      const Image texture = texture_of(model, "Sheet");
      EXPECT_EQ(texture.bits, wanted.bits);
      EXPECT_EQ(count_wrong(texture, plain, wanted.tolerance), 0);
      if (wanted.tolerance == 0) {
        EXPECT_TRUE(std::equal(texture.pixel(0, 0), texture.pixel(0, 0) + 40000, noise_.pixel(0, 0)))
            << "what the decal does not cover stays";
      }
      EXPECT_EQ("image/" + report()["textures"][0]["format"].get<std::string>(), wanted.media_type);
      const bool webp = std::string(wanted.media_type) == "image/webp";
      for (const char* list : {"extensionsUsed", "extensionsRequired"})
        EXPECT_EQ(model.document.json.value(list, json::array()),
                  webp ? json::array({"EXT_texture_webp"}) : json::array());
      EXPECT_EQ(model.document.json["textures"][0].contains("source"), !webp);
      expect_valid(name);
    }
}

TEST_F(TextureFormats, QualityIsObeyed) {
  for (const std::string format : {"jpeg", "webp"}) {
    std::vector<std::size_t> sizes;
    for (const char* quality : {"30", "90"}) {
      ASSERT_EQ(
          bake(job_at(0, 0, 0), "-o out.glb --texture-format " + format + " --texture-quality " + quality)
              .status,
          0);
      sizes.push_back(stored_texture(output()).size());
    }
    EXPECT_LT(sizes[0], sizes[1]) << format;
  }
}

TEST_F(TextureFormats, TransparencyStaysAPng) {
  edit_model([](Document& document) {
    set_slot_image(document, 0, MaterialSlot::base_color, encode_png(with_transparency()).value());
  });
  const CommandResult result =
      bake(job_at(0, 0, 0), "-o out.glb --report report.json --texture-format jpeg --texture-quality 80");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("the baseColor texture of 'paint' is stored as a PNG: JPEG has no transparency"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(media_type_of(stored_texture(output())), "image/png");
  EXPECT_EQ(texture_of(output(), "Sheet").pixel(3, 0)[3], 257 * 100);
  EXPECT_EQ(report()["textures"][0]["format"], "png");
  EXPECT_EQ(report()["warnings"][0]["code"], "texture_is_png");
  ASSERT_EQ(bake(job_at(0, 0, 0), "-o out.glb --texture-format webp --texture-quality 100").status, 0);
  EXPECT_EQ(texture_of(output(), "Sheet").pixel(3, 0)[3], 257 * 100) << "WebP has transparency";
}

TEST_F(TextureFormats, WhatIsTooLargeForWebpIsAPng) {
  const Image wide = make_image(webp_largest_side + 1, 2, {0, 0, 0, 0xffff});
  const auto encoded = encode_texture(wide, {TextureFormat::webp, 80, std::nullopt});
  ASSERT_TRUE(encoded) << encoded.error().message;
  EXPECT_EQ(encoded->format, TextureFormat::png);
  EXPECT_EQ(media_type_of(encoded->bytes), "image/png");
  EXPECT_EQ(encoded->why_png, "WebP has at most 16383 texels a side");
}

TEST_F(TextureFormats, OverlaysAreStoredAlike) {
  json job = job_at(0, 0, 0);
  job["decals"][0]["output"] = "overlay";
  ASSERT_EQ(bake(job, "-o out.glb --texture-format webp --texture-quality 100").status, 0);
  const Model model = output();
  const ModelPart& part = part_named(model, "crest");
  const auto bytes = read_image_bytes(model.document, model.materials[part.material.value()].image.value());
  EXPECT_EQ(media_type_of(bytes.value()), "image/webp");
  EXPECT_EQ(texture_of(model, "crest").rgba, make_quarters().rgba);
  expect_valid("out.glb");
}

TEST_F(TextureFormats, WrongCombinationsAreWrongUsage) {
  folder_.write("job.json", job_at(0, 0, 0));
  for (const char* options :
       {"--texture-quality 80", "--texture-format png --texture-quality 80", "--texture-bits 12",
        "--texture-format jpeg --texture-bits 16", "--texture-format webp --texture-bits 16",
        "--texture-format ktx2", "--texture-format jpeg --texture-quality 0",
        "--texture-format jpeg --texture-quality 101", "--texture-format jpeg --texture-quality 90.5"}) {
    const CommandResult result = folder_.run(std::string("bake job.json -o out.glb ") + options);
    EXPECT_EQ(result.status, 1) << options << "\n" << result.err;
    EXPECT_NE(result.err.find("--texture-"), std::string::npos) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.glb"));
  EXPECT_NE(folder_.run("bake job.json -o out.glb --texture-format jpeg --texture-quality 90.5")
                .err.find("--texture-quality: 90.5: expected a whole number from 1 to 100"),
            std::string::npos);
}

TEST_F(TextureFormats, ExtensionsMayBeInCapitals) {
  for (const char* name : {"out.GLB", "out.GLTF"}) {
    const CommandResult result = bake(job_at(0, 0, 0), std::string("--preview view.PNG -o ") + name);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(output(name).document.is_glb, name == std::string("out.GLB"));
    EXPECT_EQ(count_wrong(texture_of(output(name), "Sheet"), plain), 0);
    EXPECT_TRUE(read_image(folder_ / "view.PNG")) << "the preview";
  }
}

TEST_F(TextureFormats, CutOffTexturesAreNamedByCheckAndBake) {
  edit_model([](Document& document) {
    auto png = encode_png(make_noise(texture_size)).value();
    png.resize(png.size() / 2);
    set_slot_image(document, 0, MaterialSlot::base_color, png);
  });
  const CommandResult baked = bake(job_at(0, 0, 0)), checked = folder_.run("check job.json");
  for (const CommandResult& result : {baked, checked}) {
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("applique: error: image 'model.glb, image 0': the file is cut off"),
              std::string::npos)
        << result.err;
  }
  EXPECT_EQ(baked.err.find("libpng"), std::string::npos) << baked.err;
}

TEST_F(TextureFormats, SeparateFilesTakeNobodysPlace) {
  // The names that the output's files would have, taken by what the job reads and writes.
  std::filesystem::rename(folder_ / "image.png", folder_ / "out_image.png");
  const std::string decal_before = folder_.read("out_image.png");
  json job = job_at(0, 0, 0);
  job["decals"][0]["image"] = "out_image.png";
  edit_model([](Document& document) { document.json["images"][0]["name"] = "image"; });
  const CommandResult result = bake(job, "-o out.gltf --report out.bin");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"job.json", "model.glb", "out.bin", "out.gltf",
                                                       "out_2.bin", "out_image.png", "out_image_2.png"}));
  EXPECT_EQ(folder_.read("out_image.png"), decal_before);
  EXPECT_TRUE(json::parse(folder_.read("out.bin")).is_object()) << "the report";
  EXPECT_EQ(count_wrong(texture_of(output("out.gltf"), "Sheet"), plain), 0);
  // Baked again, the files of the last time are replaced.
  ASSERT_EQ(bake(job, "-o out.gltf --report out.bin").status, 0);
  EXPECT_EQ(folder_.names().size(), 7u);
}

TEST_F(TextureFormats, SeparateFilesAreAllThatIsWritten) {
  edit_model([&](Document& document) {
    // A second texture, which the bake does not touch.
    auto& root = document.json;
    const std::size_t image = add_image(document, encode_png(make_noise(32)).value(), "glow");
    root["textures"].push_back({{"source", image}});
    root["materials"][0]["emissiveTexture"]["index"] = root["textures"].size() - 1;
  });
  ASSERT_EQ(bake(job_at(0, 0, 0), "-o out.gltf --texture-format jpeg").status, 0);
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"image.png", "job.json", "model.glb", "out.bin",
                                                       "out.gltf", "out_glow.png", "out_image.jpg"}));
  EXPECT_EQ(read_image(folder_ / "out_glow.png").value().rgba, make_noise(32).rgba);
  EXPECT_LT(std::filesystem::file_size(folder_ / "out.bin"), 8000u) << "no texture is left in the buffer";
  expect_valid("out.gltf");
}

TEST_F(TextureFormats, BakesIntoEveryKindOfBaseColour) {
  const auto expect_baked = [&](const Bytes& bytes, const std::string& what, int channels, int bits) {
    SCOPED_TRACE(what);
    const Image before = decode_image(bytes, what).value();
    edit_model([&](Document& document) { set_slot_image(document, 0, MaterialSlot::base_color, bytes); });
    const CommandResult result = bake(job_at(0, 0, 0));
    ASSERT_EQ(result.status, 0) << result.err;
    const Image after = texture_of(output(), "Sheet");
    EXPECT_EQ(after.channels, channels);
    EXPECT_EQ(after.bits, bits);
    EXPECT_EQ(count_wrong(after, plain), 0);
    for (int x = 0; x < before.width; ++x)
      for (int c = 0; c < 4; ++c)
        ASSERT_EQ(after.pixel(x, 2)[c], before.pixel(x, 2)[c]) << "uncovered texel " << x;
  };
  for (const int bits : {8, 16})
    for (const int channels : {1, 2, 3, 4}) {
      Image image = with_transparency();
      image.channels = channels;
      image.bits = bits;
      if (bits == 16) image.pixel(7, 2)[0] = 12345;
      for (std::size_t i = 0; channels < 3 && i < image.rgba.size(); ++i)
        if (i % 4 != 3) image.rgba[i] = image.rgba[i - i % 4];
      // A grey texture that is given colours becomes a coloured one.
      expect_baked(encode_png(image).value(), std::to_string(channels) + " channels",
                   channels < 3 ? channels + 2 : channels, bits);
    }
  expect_baked(encode_jpeg(noise_, 90).value(), "JPEG", 3, 8);
  expect_baked(encode_webp(with_transparency(), 90).value(), "WebP", 4, 8);
  if (test_data().empty()) return;
  const auto palette = read_file(test_data() / "images/mediapipe/glasses_uvtex.png").value();
  expect_baked(palette, "palette with transparency", 4, 8);
}

TEST_F(TextureFormats, Ktx2IsNotReadAndTheErrorSaysWhatToDo) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  edit_model([](Document& document) {
    const auto ktx = read_file(test_data() / "images/formats/2d_uastc.ktx2").value();
    set_slot_image(document, 0, MaterialSlot::base_color, ktx);
    document.json["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 0;
    document.json["textures"][0].erase("source");
    document.json["extensionsUsed"] = {"KHR_texture_basisu"};
  });
  const CommandResult result = bake(job_at(0, 0, 0));
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("image 'model.glb, image 0'"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("gltf-transform ktxdecompress"), std::string::npos) << result.err;
  // As another texture than the one that is baked into, it is no obstacle and stays.
  edit_model([](Document& document) {
    const std::size_t image = add_image(document, encode_png(make_noise(64)).value(), "paint");
    document.json["textures"].push_back({{"source", image}});
    document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
    document.json["materials"][0]["normalTexture"]["index"] = 0;
  });
  ASSERT_EQ(bake(job_at(0, 0, 0)).status, 0);
  EXPECT_EQ(read_image_bytes(output().document, 0).value(),
            read_file(test_data() / "images/formats/2d_uastc.ktx2").value());
}

TEST_F(TextureFormats, BakesBesideKtx2OfARealModel) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const auto lamp = test_data() / "gltf/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf";
  const Model before = load_model(lamp).value();
  // Where the base colour is a JPEG.
  const ModelPart* part = nullptr;
  for (const ModelPart& candidate : before.parts)
    if (candidate.material && before.materials[*candidate.material].image && !candidate.uvs.empty())
      part = &candidate;
  ASSERT_NE(part, nullptr);
  json job = job_at(0, 0, 0);
  job["model"] = lamp.string();
  job["decals"][0]["size"] = 0.02 * before.diagonal();
  job["decals"][0]["up"] = {0.1, 1, 0.2};
  job["decals"][0]["features"] = {{{"image", {32, 32}},
                                   {"triangle", part->triangles.size() / 2},
                                   {"barycentric", {0.4, 0.3, 0.3}},
                                   {"mesh", part->mesh},
                                   {"primitive", part->primitive}}};
  const CommandResult result = bake(job, "-o out.glb");
  ASSERT_EQ(result.status, 0) << result.err;
  const Model after = output();
  for (std::size_t i = 0; i < count_of(before.document, "images"); ++i) {
    const auto old = read_image_bytes(before.document, i).value();
    if (media_type_of(old) != "image/ktx2") continue;
    const std::string uri = after.document.json["images"][i].value("uri", "");
    const auto now = read_image_bytes(after.document, i);
    EXPECT_TRUE((now && *now == old) || uri == before.document.json["images"][i].value("uri", "")) << i;
  }
}

/// Decal images of every kind show the same four quarters.
TEST_F(TextureFormats, DecalImagesOfEveryKind) {
  const auto expect_quarters = [&](const std::string& name, int tolerance) {
    SCOPED_TRACE(name);
    json job = job_at(0, 0, 0);
    job["decals"][0]["image"] = name;
    const CommandResult result = bake(job);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(count_wrong(texture_of(output(), "Sheet"), plain, tolerance), 0);
  };
  const Image quarters = make_quarters();
  Image wide = quarters;
  wide.bits = 16;
  write_png(folder_ / "wide.png", wide);
  expect_quarters("wide.png", 0);
  write_bytes(folder_ / "decal.jpg", encode_jpeg(quarters, 98).value());
  expect_quarters("decal.jpg", 6);
  write_bytes(folder_ / "decal.webp", encode_webp(quarters, 100).value());
  expect_quarters("decal.webp", 0);
  // Light, of which more than 1 is 1.
  std::vector<float> light;
  for (std::size_t i = 0; i < quarters.rgba.size(); ++i)
    if (i % 4 != 3) light.push_back(quarters.rgba[i] != 0 ? 3.0F : 0.0F);
  for (const char* name : {"decal.exr", "decal.hdr", "decal.tif"}) {
    const auto out = OIIO::ImageOutput::create((folder_ / name).string());
    ASSERT_TRUE(out &&
                out->open((folder_ / name).string(),
                          OIIO::ImageSpec(image_size, image_size, 3, OIIO::TypeDesc::FLOAT)) &&
                out->write_image(OIIO::TypeDesc::FLOAT, light.data()) && out->close());
    expect_quarters(name, 1);
  }
}

TEST_F(TextureFormats, FloatDecalsAreLinearLight) {
  const std::vector<float> half(3 * image_size * image_size, 0.5F);
  const std::string name = (folder_ / "half.exr").string();
  const auto out = OIIO::ImageOutput::create(name);
  ASSERT_TRUE(out && out->open(name, OIIO::ImageSpec(image_size, image_size, 3, OIIO::TypeDesc::HALF)) &&
              out->write_image(OIIO::TypeDesc::FLOAT, half.data()) && out->close());
  json job = job_at(0, 0, 0);
  job["decals"][0]["image"] = "half.exr";
  ASSERT_EQ(bake(job).status, 0);
  const Image texture = texture_of(output(), "Sheet");
  const std::uint16_t* middle = texture.pixel(texture_size / 2, texture_size / 2);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(middle[c], 188 * 257) << "sRGB of 0.5";
}

}  // namespace
}  // namespace applique
