// What the program writes: run it as a command, read the outputs back.

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "model.h"
#include "schema.h"

using namespace applique;
using nlohmann::json;

namespace {

constexpr int image_size = 64;
constexpr int texture_size = 256;
constexpr std::array<std::uint16_t, 4> red = {0xffff, 0, 0, 0xffff};
constexpr std::array<std::uint16_t, 4> green = {0, 0xffff, 0, 0xffff};
constexpr std::array<std::uint16_t, 4> blue = {0, 0, 0xffff, 0xffff};
constexpr std::array<std::uint16_t, 4> white = {0xffff, 0xffff, 0xffff, 0xffff};

/// Red, green on top; blue, white below.
Image make_quarters() {
  Image image = make_image(image_size, image_size, white);
  image.channels = 3;
  for (int y = 0; y < image_size; ++y)
    for (int x = 0; x < image_size; ++x) {
      const bool left = x < image_size / 2;
      const auto& colour = y < image_size / 2 ? (left ? red : green) : (left ? blue : white);
      std::copy(colour.begin(), colour.end(), image.pixel(x, y));
    }
  return image;
}

std::array<std::uint16_t, 4> colour_at(const Image& image, int x, int y) {
  const std::uint16_t* p = image.pixel(x, y);
  return {p[0], p[1], p[2], p[3]};
}

/// Two planes that share one textured material; a bare one, without texture coordinates or material, behind
/// them. The image lies upright on the middle half of the left plane, pinned at two points.
class BakeTest : public testing::Test {
 protected:
  void SetUp() override {
    SmallMesh bare = make_plane("Bare", 8, 0, -3);
    bare.uvs.clear();
    bare.material = -1;
    SmallMesh plain = make_plane("Plain", 8, 0, -6);
    plain.material = 1;
    write_small_model(folder_ / "model.glb",
                      {make_plane("Left", 8, -2), make_plane("Right", 8, 2), bare, plain},
                      {{"paint", texture_, {1, 1, 1, 1}}, {"plain", std::nullopt, {0.5, 0.25, 1, 1}}});
    write_png(folder_ / "image.png", make_quarters());
  }

  static json job_at(double x, double z) {
    return {{"version", 1},
            {"model", "model.glb"},
            {"texture_size", texture_size},
            {"decals", json::array({{{"name", "crest"},
                                     {"image", "image.png"},
                                     {"features",
                                      {{{"image", {16, 32}}, {"position", {x - 0.25, 0, z}}},
                                       {{"image", {48, 32}}, {"position", {x + 0.25, 0, z}}}}}}})}};
  }

  CommandResult bake(const json& job, const std::string& arguments = "-o out.glb --report report.json") {
    folder_.write("job.json", job);
    return folder_.run("bake job.json " + arguments);
  }

  json valid_report() {
    const json report = json::parse(folder_.read("report.json"));
    const auto valid = check_schema(report, report_schema(), "report.json");
    EXPECT_TRUE(valid) << valid.error().message;
    return report;
  }

  CommandFolder folder_;
  Image texture_ = make_noise(texture_size);
};

/// The image covers the middle half of the texture; a margin around its border is left out.
void expect_quarters(const Image& texture, const Image* before) {
  constexpr int margin = 3;
  constexpr int low = texture_size / 4;
  constexpr int middle = texture_size / 2;
  constexpr int high = 3 * texture_size / 4;
  int wrong = 0;
  int changed = 0;
  for (int y = 0; y < texture_size; ++y)
    for (int x = 0; x < texture_size; ++x) {
      const auto near = [&](int border) {
        return std::abs(x - border) < margin || std::abs(y - border) < margin;
      };
      if (near(low) || near(middle) || near(high)) continue;
      if (x > low && x < high && y > low && y < high) {
        const auto& expected = y < middle ? (x < middle ? red : green) : (x < middle ? blue : white);
        wrong += colour_at(texture, x, y) != expected;
      } else if (before != nullptr) {
        changed += colour_at(texture, x, y) != colour_at(*before, x, y);
      }
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(changed, 0);
}

/// The material of the part under the node of this name.
const ModelPart& part_named(const Model& model, const std::string& name) {
  for (const ModelPart& part : model.parts)
    if (model.document.json["nodes"][part.node].value("name", "") == name) return part;
  throw std::runtime_error("no part " + name);
}

TEST_F(BakeTest, PutsItThereByEveryRival) {
  for (const char* method : {"planar", "expmap", "stroke"}) {
    SCOPED_TRACE(method);
    json job = job_at(-2, 0);
    job["decals"][0]["method"] = method;
    const CommandResult result = bake(job);
    ASSERT_EQ(result.status, 0) << result.err;
    const json decal = valid_report()["decals"][0];
    EXPECT_EQ(decal["method"], method);
    EXPECT_EQ(decal["coverage_status"], "covered");
    EXPECT_EQ(decal["warnings"], json::array());
    const auto model = load_model(folder_ / "out.glb");
    ASSERT_TRUE(model) << model.error().message;
    const auto texture =
        load_model_image(*model, *model->materials[*part_named(*model, "Left").material].image);
    ASSERT_TRUE(texture);
    expect_quarters(*texture, &texture_);
  }
}

/// What a method or an output has no use for is not passed over in silence.
TEST_F(BakeTest, WarnsOfOptionsWithoutEffect) {
  const auto codes_of = [&](const json& changes) {
    json job = job_at(-2, 0);
    job["decals"][0].update(changes);
    folder_.write("job.json", job);
    EXPECT_EQ(folder_.run("check job.json --report report.json").status, 0);
    std::vector<std::string> codes;
    const json report = valid_report();
    for (const json& warning : report["decals"][0]["warnings"]) codes.push_back(warning["code"]);
    return codes;
  };
  using Codes = std::vector<std::string>;
  const json options = {{"energy", 0.5}, {"guide", false}, {"overlap", "allow"}};
  EXPECT_EQ(codes_of(options), Codes());
  for (const char* method : {"planar", "expmap", "stroke"}) {
    json changes = options;
    changes["method"] = method;
    EXPECT_EQ(codes_of(changes), Codes({"energy_ignored", "guide_ignored", "overlap_ignored"})) << method;
  }
  EXPECT_EQ(codes_of({{"method", "planar"}}), Codes());
  const json overlay = {
      {"output", "overlay"}, {"uv_conflict", "share"}, {"instance", "all"}, {"offset", 0.01}};
  EXPECT_EQ(codes_of(overlay), Codes({"instance_ignored", "uv_conflict_ignored"}));
  EXPECT_EQ(codes_of({{"offset", 0.01}}), Codes({"offset_ignored"}));
}

TEST_F(BakeTest, LaysARivalOverTheModelAsWell) {
  json job = job_at(-2, 0);
  job["decals"][0].update({{"method", "expmap"}, {"output", "overlay"}});
  const CommandResult result = bake(job, "-o out.glb --report report.json --preview preview.png");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(valid_report()["decals"][0]["output"], "overlay");
  EXPECT_TRUE(load_model(folder_ / "out.glb"));
}

TEST_F(BakeTest, ReportsWhatARivalMissesAndLeavesOut) {
  json job = job_at(-2, 0);
  // A third feature that is off: the nearest to the middle is met.
  job["decals"][0]["features"].push_back({{"image", {32, 30}}, {"position", {-2, 0.1, 0}}});
  for (const char* method : {"planar", "expmap", "stroke"}) {
    job["decals"][0]["method"] = method;
    folder_.write("job.json", job);
    const CommandResult checked = folder_.run("check job.json --report report.json");
    ASSERT_EQ(checked.status, 0) << checked.err;
    const json decal = valid_report()["decals"][0];
    EXPECT_LT(decal["features"][2]["residual_px"], 1e-9);
    EXPECT_GT(decal["features"][0]["residual_px"], 1);
    EXPECT_EQ(decal["warnings"][0]["code"], "features_missed");
  }
  job["decals"][0].update({{"method", "planar"}, {"planar", {{"depth", 0.1}, {"normal_limit", 20}}}});
  folder_.write("job.json", job);
  EXPECT_EQ(folder_.run("check job.json").status, 0) << "flat, so within any limits";
}

TEST_F(BakeTest, PutsTheImageThereAndNowhereElse) {
  const CommandResult result = bake(job_at(-2, 0));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(folder_.names(),
            (std::vector<std::string>{"image.png", "job.json", "model.glb", "out.glb", "report.json"}));

  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model) << model.error().message;
  const auto left = *part_named(*model, "Left").material;
  const auto right = *part_named(*model, "Right").material;
  EXPECT_NE(left, right) << "the material is split, since the right plane shares it";
  const auto left_image = load_model_image(*model, *model->materials[left].image);
  const auto right_image = load_model_image(*model, *model->materials[right].image);
  ASSERT_TRUE(left_image && right_image);
  expect_quarters(*left_image, &texture_);
  EXPECT_EQ(right_image->rgba, texture_.rgba);

  const json report = valid_report();
  EXPECT_EQ(report["command"], "bake");
  EXPECT_FALSE(report["device"].is_null());
  EXPECT_EQ(report["outputs"]["model"], "out.glb");
  ASSERT_EQ(report["textures"].size(), 1u);
  EXPECT_FALSE(report["textures"][0]["created"]);
  const json& decal = report["decals"][0];
  EXPECT_EQ(decal["coverage_status"], "covered");
  EXPECT_NEAR(decal["coverage"].get<double>(), 1, 1e-9);
  EXPECT_NEAR(decal["area"].get<double>(), 1, 1e-9);
  EXPECT_NEAR(decal["stretch"]["l2"].get<double>(), 1, 1e-9);
  EXPECT_EQ(decal["flipped"]["image"], 0);
  EXPECT_LT(decal["features"][1]["residual_px"].get<double>(), 1e-6);
  EXPECT_NEAR(decal["texel_density"]["texels_per_unit"].get<double>(), texture_size / 2.0, 1e-6);
  EXPECT_NEAR(decal["texel_density"]["texels_per_pixel"].get<double>(), 2, 1e-6);
  EXPECT_EQ(decal["warnings"], json::array()) << decal["warnings"];
}

/// Two nodes, meshes and materials that meet at x = 0: one surface to a decal, which lies half on each.
/// A mirrored decal of the mirrored image is the image.
TEST_F(BakeTest, MirroredTwiceIsPlain) {
  Image turned = make_quarters();
  for (int y = 0; y < image_size; ++y)
    for (int x = 0; x < image_size; ++x) {
      const auto colour = colour_at(make_quarters(), image_size - 1 - x, y);
      std::copy(colour.begin(), colour.end(), turned.pixel(x, y));
    }
  write_png(folder_ / "turned.png", turned);
  json job = job_at(-2, 0);
  job["decals"][0]["image"] = "turned.png";
  job["decals"][0]["mirrored"] = true;
  for (json& feature : job["decals"][0]["features"])
    feature["image"][0] = image_size - feature["image"][0].get<int>();
  const CommandResult result = bake(job);
  ASSERT_EQ(result.status, 0) << result.err;
  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model) << model.error().message;
  const auto texture =
      load_model_image(*model, *model->materials[*part_named(*model, "Left").material].image);
  ASSERT_TRUE(texture);
  expect_quarters(*texture, &texture_);
}

TEST_F(BakeTest, CrossesFromOneMaterialToAnother) {
  write_small_model(folder_ / "model.glb",
                    {make_plane("Left", 8, -1),
                     [] {
                       SmallMesh right = make_plane("Right", 8, 1);
                       right.material = 1;
                       return right;
                     }()},
                    {{"paint", texture_, {1, 1, 1, 1}}, {"paper", texture_, {1, 1, 1, 1}}});
  const CommandResult result = bake(job_at(0, 0));
  ASSERT_EQ(result.status, 0) << result.err;
  const json report = valid_report();
  EXPECT_EQ(report["decals"][0]["coverage_status"], "covered");
  EXPECT_EQ(report["textures"].size(), 2u);
  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model) << model.error().message;
  const auto texture_of = [&](const char* name) {
    return load_model_image(*model, *model->materials[*part_named(*model, name).material].image).value();
  };
  const Image left = texture_of("Left"), right = texture_of("Right");
  // A plane is two units wide, the image one: it takes the quarter of each texture at their common border.
  for (const int y : {texture_size * 3 / 8, texture_size * 5 / 8}) {
    const bool top = y < texture_size / 2;
    for (const int from_border : {3, 10, texture_size / 4 - 4}) {
      EXPECT_EQ(colour_at(left, texture_size - from_border, y), top ? red : blue);
      EXPECT_EQ(colour_at(right, from_border - 1, y), top ? green : white);
    }
    EXPECT_EQ(colour_at(left, texture_size * 3 / 4 - 4, y), colour_at(texture_, texture_size * 3 / 4 - 4, y));
    EXPECT_EQ(colour_at(right, texture_size / 4 + 4, y), colour_at(texture_, texture_size / 4 + 4, y));
  }
}

TEST_F(BakeTest, MakesATextureOfTheFactorsColour) {
  const CommandResult result = bake(job_at(0, -6));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model) << model.error().message;
  const ModelMaterial& material = model->materials[*part_named(*model, "Plain").material];
  EXPECT_EQ(material.base_colour_factor, (std::array<double, 4>{1, 1, 1, 1}));
  const auto image = load_model_image(*model, *material.image);
  ASSERT_TRUE(image);
  // sRGB of 0.5, 0.25, 1.
  const Image before = make_image(texture_size, texture_size, {188 * 257, 137 * 257, 0xffff, 0xffff});
  expect_quarters(*image, &before);
  EXPECT_TRUE(valid_report()["textures"][0]["created"]);
}

TEST_F(BakeTest, OverlayIsAMeshOfItsOwn) {
  json job = job_at(0, -3);
  job["decals"][0]["output"] = "overlay";
  job["decals"][0]["offset"] = 0.125;
  const CommandResult result = bake(job);
  ASSERT_EQ(result.status, 0) << result.err;
  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model) << model.error().message;
  const ModelPart& part = part_named(*model, "crest");
  EXPECT_EQ(model->document.json["meshes"][part.mesh]["name"], "crest");
  EXPECT_EQ(model->materials[*part.material].alpha_mode, "BLEND");
  // The plane is flat, so the overlay is the image's square, with the same linear texture coordinates
  // everywhere.
  double area = 0;
  for (const auto& t : part.triangles)
    area +=
        0.5 *
        (part.positions[t[1]] - part.positions[t[0]]).cross(part.positions[t[2]] - part.positions[t[0]]).z();
  EXPECT_NEAR(area, 1, 1e-5);
  for (std::size_t i = 0; i < part.positions.size(); ++i) {
    EXPECT_NEAR(part.positions[i].z(), -3 + 0.125, 1e-6);
    EXPECT_NEAR(part.uvs[i][0], part.positions[i].x() + 0.5, 1e-6);
    EXPECT_NEAR(part.uvs[i][1], 0.5 - part.positions[i].y(), 1e-6);
  }
  const json report = valid_report();
  EXPECT_TRUE(report["decals"][0]["texel_density"].is_null());
  EXPECT_EQ(report["textures"], json::array());
}

TEST_F(BakeTest, LaterDecalsLieOverEarlierOnes) {
  json job = job_at(-2, 0);
  write_png(folder_ / "black.png", make_image(image_size, image_size, {0, 0, 0, 0xffff}));
  json under = job["decals"][0];
  under["name"] = "under";
  under["image"] = "black.png";
  job["decals"].insert(job["decals"].begin(), under);
  ASSERT_EQ(bake(job).status, 0);
  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model);
  const auto image = load_model_image(*model, *model->materials[*part_named(*model, "Left").material].image);
  ASSERT_TRUE(image);
  expect_quarters(*image, &texture_);
}

/// Three decals, two on one material and one over it on another, in one run: each material gets what lies on
/// it.
TEST_F(BakeTest, SeveralDecalsShareTexturesAndKeepTheirOwn) {
  json job = job_at(-2, 0);
  write_png(folder_ / "black.png", make_image(image_size, image_size, {0, 0, 0, 0xffff}));
  json under = job["decals"][0];
  under["name"] = "under";
  under["image"] = "black.png";
  json elsewhere = job_at(0, -6)["decals"][0];
  elsewhere["name"] = "elsewhere";
  job["decals"] = {under, job["decals"][0], elsewhere};
  ASSERT_EQ(bake(job).status, 0);
  const json report = valid_report();
  EXPECT_EQ(report["decals"].size(), 3U);
  EXPECT_EQ(report["textures"].size(), 2U);
  const auto model = load_model(folder_ / "out.glb");
  ASSERT_TRUE(model) << model.error().message;
  const auto texture_of = [&](const char* name) {
    return load_model_image(*model, *model->materials[*part_named(*model, name).material].image).value();
  };
  expect_quarters(texture_of("Left"), &texture_);
  const Image plain = make_image(texture_size, texture_size, {188 * 257, 137 * 257, 0xffff, 0xffff});
  expect_quarters(texture_of("Plain"), &plain);
}

TEST_F(BakeTest, ClippedCoverageIsWarnedOf) {
  json job = job_at(-2.75, 0);  // a quarter of the image hangs over the plane's edge
  ASSERT_EQ(bake(job).status, 0);
  const json decal = valid_report()["decals"][0];
  EXPECT_EQ(decal["coverage_status"], "clipped_by_boundary");
  EXPECT_NEAR(decal["coverage"].get<double>(), 0.75, 1e-6);
  ASSERT_EQ(decal["warnings"].size(), 1u) << decal["warnings"];
  EXPECT_EQ(decal["warnings"][0]["code"], "clipped_by_boundary");
}

TEST_F(BakeTest, WritesGltfWithItsFiles) {
  ASSERT_EQ(bake(job_at(-2, 0), "-o out.gltf").status, 0);
  const auto model = load_model(folder_ / "out.gltf");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_FALSE(model->document.is_glb);
  const auto image = load_model_image(*model, *model->materials[*part_named(*model, "Left").material].image);
  ASSERT_TRUE(image) << image.error().message;
  expect_quarters(*image, &texture_);
  for (const std::string& name : folder_.names()) EXPECT_EQ(name.find(".tmp"), std::string::npos) << name;
}

TEST_F(BakeTest, PreviewFramesTheDecal) {
  const CommandResult result = bake(job_at(-2, 0), "-o out.glb --preview preview.png");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto preview = read_image(folder_ / "preview.png");
  ASSERT_TRUE(preview) << preview.error().message;
  // The decal is in the middle, upright, and fills more than a third of the picture.
  const auto is_like = [&](double u, double v, int strong) {
    const std::uint16_t* p =
        preview->pixel(static_cast<int>(u * preview->width), static_cast<int>(v * preview->height));
    bool like = true;
    for (int c = 0; c < 3; ++c) like = like && (c == strong || p[strong] > 2 * p[c]);
    return like;
  };
  const double aspect = static_cast<double>(preview->height) / preview->width;
  EXPECT_TRUE(is_like(0.5 - 0.2 * aspect, 0.3, 0));
  EXPECT_TRUE(is_like(0.5 + 0.2 * aspect, 0.3, 1));
  EXPECT_TRUE(is_like(0.5 - 0.2 * aspect, 0.7, 2));
}

TEST_F(BakeTest, QuietSaysNothing) {
  const CommandResult result = bake(job_at(-2, 0), "-o out.glb --quiet");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out, "");
}

TEST_F(BakeTest, ProgressIsForTerminalsOnly) {
  const CommandResult result = bake(job_at(-2, 0), "-o out.glb --verbose");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err.find('\r'), std::string::npos);
  for (const char* stage : {"solving 'crest'", "preparing the textures", "encoding the textures"})
    EXPECT_NE(result.err.find(stage), std::string::npos) << stage << "\nin: " << result.err;
}

TEST_F(BakeTest, CheckReportsTheSameGeometryAndDumpsTheRegion) {
  json job = job_at(-2, 0);
  job["decals"][0]["region"] = {{"contour", {{4, 4}, {60, 4}, {60, 60}, {4, 60}}}};
  folder_.write("job.json", job);
  ASSERT_EQ(folder_.run("check job.json --report report.json --dump-region regions.json").status, 0);
  const json report = valid_report();
  EXPECT_EQ(report["command"], "check");
  EXPECT_TRUE(report["device"].is_null());
  EXPECT_NEAR(report["decals"][0]["area"].get<double>(), 56.0 * 56 / 64 / 64, 1e-9);

  const json regions = json::parse(folder_.read("regions.json"));
  job["decals"][0]["region"] = regions["crest"];
  folder_.write("job.json", job);
  ASSERT_EQ(folder_.run("check job.json --report report.json").status, 0);
  EXPECT_NEAR(valid_report()["decals"][0]["area"].get<double>(), 56.0 * 56 / 64 / 64, 1e-9);
}

/// The suggested feature, pasted into the job, does what the report says; so does leaving one out.
TEST_F(BakeTest, SuggestionsHoldWhatTheyPromise) {
  const auto l2_of = [&](const json& job, const std::string& arguments) {
    folder_.write("job.json", job);
    const CommandResult result = folder_.run("check job.json --report report.json " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return valid_report()["decals"][0]["stretch"]["l2"].get<double>();
  };
  write_small_model(folder_ / "fine.glb", {make_plane("Fine", 40)}, {{"plain", std::nullopt, {1, 1, 1, 1}}});
  json job = job_at(0, 0);
  job["model"] = "fine.glb";
  json& features = job["decals"][0]["features"];
  features.clear();
  for (const auto& [x, y] : {std::pair{32, 32}, {16, 16}, {48, 16}, {48, 48}, {16, 48}})
    features.push_back({{"image", {x, y}}, {"position", {(x - 32) / 64.0, (32 - y) / 64.0, 0}}});
  job["decals"][0]["guide"] = false;  // With it there is nothing left to gain.
  features[0]["position"][0] = 0.075;
  const double before = l2_of(job, "");
  EXPECT_TRUE(valid_report()["decals"][0]["suggestions"].is_null());
  l2_of(job, "--suggest");
  const json suggestions = valid_report()["decals"][0]["suggestions"];
  EXPECT_NEAR(suggestions["l2"].get<double>(), before, 1e-12);
  ASSERT_TRUE(suggestions["add"].is_object());
  ASSERT_TRUE(suggestions["leave_out"].is_object());
  EXPECT_EQ(suggestions["leave_out"]["feature"], 0);

  json with = job;
  json further = suggestions["add"];
  further.erase("l2");
  with["decals"][0]["features"].push_back(further);
  const double after = l2_of(with, "");
  EXPECT_LT(after, 0.999 * before);
  EXPECT_EQ(after, suggestions["add"]["l2"].get<double>()) << "to the last digit: it is what was solved";
  json without = job;
  without["decals"][0]["features"].erase(0);
  EXPECT_NEAR(l2_of(without, ""), suggestions["leave_out"]["l2"].get<double>(), 1e-6);
}

TEST_F(BakeTest, InspectTellsWhatIsInTheModel) {
  const CommandResult text = folder_.run("inspect model.glb");
  EXPECT_EQ(text.status, 0) << text.err;
  for (const char* name : {"Left", "Right", "Bare", "paint"})
    EXPECT_NE(text.out.find(name), std::string::npos) << name;
  const CommandResult machine = folder_.run("inspect model.glb --json");
  EXPECT_EQ(machine.status, 0) << machine.err;
  EXPECT_TRUE(json::parse(machine.out).is_object());
}

TEST_F(BakeTest, RenderWritesAPictureOfTheWantedSize) {
  const CommandResult result =
      folder_.run("render model.glb -o picture.png --size 120x80 --azimuth 20 --elevation 10");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto picture = read_image(folder_ / "picture.png");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 120);
  EXPECT_EQ(picture->height, 80);
  EXPECT_GT(std::set<std::uint16_t>(picture->rgba.begin(), picture->rgba.end()).size(), 20u);
}

}  // namespace
