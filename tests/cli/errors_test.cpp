// What stops a job: each error is read as a person would read it, with its exit code.

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "document.h"
#include "save_document.h"

using namespace applique;
using nlohmann::json;

namespace {

constexpr int image_size = 64;

json feature(double x, double y, double px, double py, double pz = 0) {
  return {{"image", {x, y}}, {"position", {px, py, pz}}};
}

/// A folder with a model of two planes side by side, one without texture coordinates behind them, and an
/// image.
class ErrorsTest : public testing::Test {
 protected:
  void SetUp() override {
    SmallMesh bare = make_plane("Bare", 4, 0, -3);
    bare.uvs.clear();
    write_small_model(folder_ / "model.glb", {make_plane("Left", 8, -2), make_plane("Right", 8, 2), bare},
                      {{"paint", make_noise(32), {1, 1, 1, 1}}});
    write_png(folder_ / "image.png", make_noise(image_size));
  }

  /// A job that can be solved: the image over half of the left plane.
  static json good_job() {
    return {
        {"version", 1},
        {"model", "model.glb"},
        {"decals", json::array({{{"name", "crest"},
                                 {"image", "image.png"},
                                 {"features", {feature(16, 32, -2.25, 0), feature(48, 32, -1.75, 0)}}}})}};
  }

  void expect_failure(const json& job, int status, const std::vector<std::string>& sentence_parts,
                      const std::string& command = "check job.json") {
    folder_.write("job.json", job);
    const auto before = folder_.names();
    const CommandResult result = folder_.run(command);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(result.err.find("applique: error: "), 0u) << result.err;
    for (const std::string& part : sentence_parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << part << "\nin: " << result.err;
    EXPECT_EQ(folder_.names(), before) << "a failed run leaves nothing behind";
  }

  CommandFolder folder_;
};

TEST_F(ErrorsTest, NoneInTheGoodJob) {
  folder_.write("job.json", good_job());
  const CommandResult result = folder_.run("check job.json");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("crest: 2 features"), std::string::npos) << result.err;
  EXPECT_EQ(result.out, "");
}

TEST_F(ErrorsTest, ContourThatCrossesItselfSaysWhere) {
  json job = good_job();
  job["decals"][0]["region"] = {{"contour", {{0, 0}, {64, 64}, {64, 0}, {0, 64}}}};
  expect_failure(job, 2, {"'crest'", "cross", "(32.00, 32.00)"});
}

TEST_F(ErrorsTest, FeatureOutsideTheContourSaysByHowMuch) {
  json job = good_job();
  job["decals"][0]["region"] = {{"contour", {{0, 0}, {40, 0}, {40, 64}, {0, 64}}}};
  expect_failure(job, 2, {"'crest'", "feature 1 at (48.0, 32.0)", "outside", "8.0 px"});
}

TEST_F(ErrorsTest, TwoFeaturesOnOneImagePoint) {
  json job = good_job();
  job["decals"][0]["features"][1]["image"] = {16, 32};
  expect_failure(job, 2, {"'crest'", "feature 0 at (16.0, 32.0)", "feature 1 at (16.0, 32.0)"});
}

TEST_F(ErrorsTest, TwoFeaturesOnOneSurfacePoint) {
  json job = good_job();
  job["decals"][0]["features"][1]["position"] = {-2.25, 0, 0};
  expect_failure(job, 2, {"'crest'", "feature 0 at (16.0, 32.0)", "feature 1 at (48.0, 32.0)"});
}

TEST_F(ErrorsTest, FeaturesOnPartsThatAreNotConnected) {
  json job = good_job();
  job["decals"][0]["features"][1]["position"] = {2, 0, 0};
  expect_failure(job, 3,
                 {"'crest'", "feature 0 at (16.0, 32.0)", "feature 1 at (48.0, 32.0)", "not connected"});
}

TEST_F(ErrorsTest, MirroredCorrespondences) {
  json job = good_job();
  job["decals"][0]["features"] = {feature(16, 16, -1.75, 0.25), feature(48, 16, -2.25, 0.25),
                                  feature(32, 48, -2, -0.25)};
  expect_failure(job, 3, {"'crest'", "give the decal \"mirrored\": true"});
  job["decals"][0]["mirrored"] = true;
  folder_.write("job.json", job);
  EXPECT_EQ(folder_.run("check job.json").status, 0);
  job["decals"][0]["features"] = {feature(16, 16, -2.25, 0.25), feature(48, 16, -1.75, 0.25),
                                  feature(32, 48, -2, -0.25)};
  expect_failure(job, 3, {"'crest'", "leave out \"mirrored\": true"});
}

TEST_F(ErrorsTest, PositionTooFarFromTheSurface) {
  json job = good_job();
  job["decals"][0]["features"][1]["position"] = {-1.75, 0, 1.5};
  expect_failure(job, 3, {"'crest'", "feature 1 at (48.0, 32.0)", "1.5", "max_distance"});
  job["decals"][0]["features"][1]["max_distance"] = 2;
  folder_.write("job.json", job);
  EXPECT_EQ(folder_.run("check job.json").status, 0);
}

TEST_F(ErrorsTest, SizeMissingForALoneFeature) {
  json job = good_job();
  job["decals"][0]["features"] = json::array({feature(32, 32, -2, 0)});
  expect_failure(job, 2, {"'crest'", "'size'", "'up'"});
  job["decals"][0]["size"] = 0.5;
  expect_failure(job, 2, {"'crest'", "'up'"});
  job["decals"][0]["up"] = {0, 1, 0};
  folder_.write("job.json", job);
  EXPECT_EQ(folder_.run("check job.json").status, 0);
}

TEST_F(ErrorsTest, UvsMissingNamesTheMeshAndTheWayOut) {
  json job = good_job();
  job["decals"][0]["features"] = {feature(16, 32, -0.25, 0, -3), feature(48, 32, 0.25, 0, -3)};
  job["decals"][0]["uv_conflict"] = "share";
  expect_failure(job, 3, {"'crest'", "'Bare'", "no texture coordinates", "separate", "overlay"},
                 "bake job.json -o out.glb");
  job["decals"][0]["uv_conflict"] = "error";
  expect_failure(job, 3, {"'crest'", "'paint'", "'Bare'", "no texture coordinates", "separate", "overlay"},
                 "bake job.json -o out.glb");
}

TEST_F(ErrorsTest, UnknownNodeNamesTheNearOne) {
  json job = good_job();
  job["decals"][0]["nodes"] = {"left"};
  expect_failure(job, 2, {"'crest'", "'left'", "'Left'"});
}

TEST_F(ErrorsTest, SchemaViolationSaysPointerFoundAndExpected) {
  json job = good_job();
  job["decals"][0]["opacity"] = 1.7;
  expect_failure(job, 2, {"job.json: /decals/0/opacity: found 1.7, expected a number from 0 to 1"});
}

TEST_F(ErrorsTest, UnreadableFilesAreNamed) {
  expect_failure(good_job(), 2, {"none.json"}, "check none.json");
  json job = good_job();
  job["model"] = "none.glb";
  expect_failure(job, 2, {"none.glb"});
  job = good_job();
  job["decals"][0]["image"] = "none.png";
  expect_failure(job, 2, {"'crest'", "none.png"});
  job = good_job();
  job["decals"][0]["image"] = "model.glb";
  expect_failure(job, 2, {"'crest'", "model.glb"});
  job = good_job();
  job["model"] = "image.png";
  expect_failure(job, 2, {"image.png"});
  job = good_job();
  job["decals"][0]["layers"] = {{"normal", "none.png"}};
  expect_failure(job, 2, {"decal 'crest': layer \"normal\": image 'none.png' does not exist"});
  job = good_job();
  job["decals"][0]["mask"] = "none.png";
  expect_failure(job, 2, {"decal 'crest': mask: image 'none.png' does not exist"});
}

TEST_F(ErrorsTest, ImagesThatABakeTurnsDownCheckTurnsDownToo) {
  write_png(folder_ / "black.png", make_image(image_size, image_size, {0, 0, 0, 65535}));
  const std::string whole = folder_.read("image.png");
  std::ofstream(folder_ / "cut.png", std::ios::binary) << whole.substr(0, whole.size() / 2);
  const auto expect_both = [&](const json& job, const std::string& sentence) {
    for (const char* command : {"check job.json", "bake job.json -o out.glb"}) {
      expect_failure(job, 2, {sentence}, std::string("-q ") + command);
      EXPECT_EQ(folder_.run(std::string("-q ") + command).err.find("libpng"), std::string::npos);
    }
  };
  json job = good_job();
  job["decals"][0]["image"] = "cut.png";
  expect_both(job, "decal 'crest': image 'cut.png': the file is cut off");
  for (const char* output : {"bake", "overlay"}) {
    SCOPED_TRACE(output);
    job = good_job();
    job["decals"][0]["output"] = output;
    job["decals"][0]["layers"] = {{"normal", "black.png"}};
    expect_both(job, "decal 'crest': 'black.png' is no normal map");
    job["decals"][0]["layers"] = {{"roughness", "cut.png"}};
    expect_both(job, "decal 'crest': layer \"roughness\": image 'cut.png': the file is cut off");
    job["decals"][0].erase("layers");
    job["decals"][0]["mask"] = "cut.png";
    expect_both(job, "decal 'crest': mask: image 'cut.png': the file is cut off");
  }
  // The report of a check that fails so is written all the same.
  folder_.write("job.json", job);
  EXPECT_EQ(folder_.run("check job.json --report report.json").status, 2);
  EXPECT_TRUE(json::parse(folder_.read("report.json")).is_object());
}

TEST_F(ErrorsTest, ASizeOfNextToNothingIsNamed) {
  json job = good_job();
  job["decals"][0]["features"] = json::array({feature(32, 32, -2.1, 0.1)});
  job["decals"][0].update({{"size", 1e-9}, {"up", {0, 1, 0}}});
  folder_.write("job.json", job);
  const std::string said = folder_.run("check job.json").err;
  EXPECT_NE(said.find("its \"size\" of 1e-09 is next to nothing"), std::string::npos) << said;
  EXPECT_EQ(said.find("more than once"), std::string::npos) << said;
}

TEST_F(ErrorsTest, OutputThatCannotBeWritten) {
  expect_failure(good_job(), 4, {"missing/out.glb", "does not exist"}, "bake job.json -o missing/out.glb");
  expect_failure(good_job(), 4, {"missing/r.json", "does not exist"},
                 "check job.json --report missing/r.json");
  expect_failure(good_job(), 4, {"image.png/out.glb"}, "bake job.json -o image.png/out.glb");
}

TEST_F(ErrorsTest, OutputsThatWouldDestroyFiles) {
  const std::string image = folder_.read("image.png");
  expect_failure(good_job(), 4, {"'out.glb' would be written twice"},
                 "bake job.json -o out.glb --report out.glb");
  expect_failure(good_job(), 4, {"'job.json' is an input"}, "bake job.json -o out.glb --report job.json");
  expect_failure(good_job(), 4, {"'image.png' is an input"}, "bake job.json -o out.glb --preview image.png");
  expect_failure(good_job(), 4, {"'r.json' would be written twice"},
                 "check job.json --report r.json --dump-region r.json");
  expect_failure(good_job(), 4, {"'model.glb' is an input"}, "bake job.json -o model.glb");
  expect_failure(good_job(), 4, {"'image.png' is an input"}, "render image.png -o image.png");
  EXPECT_EQ(folder_.read("image.png"), image);
}

TEST_F(ErrorsTest, OutputsThatWouldDestroyTheModelsOwnFiles) {
  Document document = load_document(folder_ / "model.glb").value();
  ASSERT_TRUE(save_document(document, folder_ / "model.gltf"));
  document = load_document(folder_ / "model.gltf").value();
  const std::vector<std::filesystem::path> files = files_of(document);
  ASSERT_EQ(files.size(), 2u) << "a buffer and a texture";
  const std::string buffer = files[0].filename().string(), texture = files[1].filename().string();
  ASSERT_TRUE(buffer.ends_with(".bin") && texture.ends_with(".png")) << buffer << ", " << texture;
  const std::string bytes = folder_.read(buffer), pixels = folder_.read(texture);
  std::filesystem::create_symlink(texture, folder_ / "link.png");
  json job = good_job();
  job["model"] = "model.gltf";
  const auto expect_kept = [&](const std::string& name, const std::string& command) {
    SCOPED_TRACE(command);
    expect_failure(job, 4, {"'" + name + "' is an input"}, command + name);
    EXPECT_EQ(folder_.read(buffer), bytes);
    EXPECT_EQ(folder_.read(texture), pixels);
  };
  for (const std::string& name : {texture, std::string("link.png"), "./" + texture}) {
    expect_kept(name, "bake job.json -o out.glb --preview ");
    expect_kept(name, "explain job.json --stage region -o ");
    expect_kept(name, "render model.gltf -o ");
  }
  for (const std::string& name : {buffer, texture}) {
    expect_kept(name, "bake job.json -o out.glb --report ");
    expect_kept(name, "check job.json --report ");
    expect_kept(name, "check job.json --dump-region ");
    expect_kept(name, "render model.gltf -o out.png --camera ");
  }
  expect_kept("model.gltf", "bake job.json -o ");
}

TEST_F(ErrorsTest, OutputsThatWouldDestroyTheJobsImages) {
  const Image grey = make_image(image_size, image_size, {30000, 30000, 30000, 65535});
  for (const char* name : {"mask.png", "gloss.png", "other.png"}) write_png(folder_ / name, grey);
  json job = good_job();
  job["decals"][0].update({{"mask", "mask.png"}, {"layers", {{"roughness", "gloss.png"}}}});
  job["decals"].push_back(job["decals"][0]);
  job["decals"][1].update({{"name", "other"}, {"image", "other.png"}});
  for (const std::string name : {"image.png", "mask.png", "gloss.png", "other.png"}) {
    const std::string before = folder_.read(name);
    for (const char* command : {"bake job.json -o out.glb --preview ", "check job.json --report ",
                                "explain job.json --stage region -o ", "render model.glb --job job.json -o "})
      expect_failure(job, 4, {"'" + name + "' is an input"}, command + name);
    EXPECT_EQ(folder_.read(name), before);
  }
}

TEST_F(ErrorsTest, OutputOfNoKnownKind) {
  expect_failure(good_job(), 1, {"out.obj", ".glb", ".gltf"}, "bake job.json -o out.obj");
  expect_failure(good_job(), 1, {"--preview", "out.jpg", ".png"},
                 "bake job.json -o out.glb --preview out.jpg");
  expect_failure(good_job(), 1, {"--output", "model.glb", ".png"}, "render model.glb -o model.glb");
}

TEST_F(ErrorsTest, ViewsThatAreNone) {
  for (const char* option : {"--zoom nan", "--zoom 0", "--zoom 1e300", "--azimuth nan", "--azimuth inf",
                             "--azimuth 1e9", "--elevation nan", "--elevation 91"}) {
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    expect_failure(good_job(), 1, {name, "expected a number from"},
                   std::string("render model.glb -o picture.png ") + option);
  }
}

TEST_F(ErrorsTest, DeviceThatIsNotThere) {
  expect_failure(good_job(), 5, {"nonsense"}, "bake job.json -o out.glb --device nonsense");
  // Told before the work: the same job that could not be solved.
  json job = good_job();
  job["decals"][0]["features"][1]["position"] = {2, 0, 0};
  expect_failure(job, 5, {"nonsense"}, "bake job.json -o out.glb --device nonsense");
  // No driver at all.
  setenv("VK_DRIVER_FILES", "/nowhere.json", 1);
  setenv("VK_ICD_FILENAMES", "/nowhere.json", 1);
  expect_failure(job, 5, {"no Vulkan device", "install a driver"}, "bake job.json -o out.glb");
  unsetenv("VK_DRIVER_FILES");
  unsetenv("VK_ICD_FILENAMES");
}

TEST(Usage, WrongUsageIsOne) {
  const CommandFolder folder;
  for (const char* arguments :
       {"", "frobnicate", "bake", "bake job.json", "check", "check job.json --frobnicate", "render model.glb",
        "check a.json --quiet --verbose", "inspect"}) {
    const CommandResult result = folder.run(arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_NE(result.err, "") << arguments;
  }
}

TEST(Usage, WithoutAKnownCommandTheyAreListed) {
  const CommandFolder folder;
  EXPECT_NE(folder.run("frobnicate")
                .err.find("there is no command 'frobnicate', expected one of bake, check, "
                          "explain, inspect, render"),
            std::string::npos);
  EXPECT_NE(folder.run("bka job.json").err.find("there is no command 'bka', expected 'bake'"),
            std::string::npos);
  EXPECT_NE(folder.run("").err.find("a command is needed: bake, check, explain, inspect, render"),
            std::string::npos);
}

TEST(Usage, HelpHasExamples) {
  const CommandFolder folder;
  for (const char* arguments : {"--help", "bake --help", "check --help", "inspect --help", "render --help"}) {
    const CommandResult result = folder.run(arguments);
    EXPECT_EQ(result.status, 0) << arguments;
    EXPECT_NE(result.out.find("Examples:\n  applique "), std::string::npos) << result.out;
  }
  EXPECT_EQ(folder.run("--version").out.find("applique "), 0u);
}

}  // namespace
