#include "job.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "schema.h"

using namespace applique;
using nlohmann::json;

namespace {

/// A folder that goes away with the test.
class JobTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("applique_job_" + std::string(info->name()) + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Result<Job> load_text(const std::string& text) {
    std::ofstream(folder_ / "job.json") << text;
    return load_job(folder_ / "job.json");
  }
  Result<Job> load(const json& job) { return load_text(job.dump()); }

  std::string message_of(const json& job) {
    const auto loaded = load(job);
    return loaded ? "no error" : loaded.error().message;
  }

  std::filesystem::path folder_;
};

json valid_job() {
  return json::parse(R"({
    "version": 1, "model": "head.glb",
    "decals": [ { "name": "tiger", "image": "tiger.png",
      "features": [
        { "image": [512, 300.5], "position": [-0.7, 1.7, 1.9] },
        { "image": [988, 300.5], "uv": [0.25, 0.5], "material": "skin" } ] } ] })");
}

TEST_F(JobTest, ReadsEveryField) {
  const auto job = load_text(R"({
    "version": 1, "model": "models/head.glb", "texture_size": 512, "seams": "exact",
    "decals": [
      { "name": "a", "image": "a.png", "mirrored": true, "region": { "contour": [[0, 0], [10, 0], [10, 20]] },
        "features": [
          { "image": [1, 2], "position": [1, 2, 3], "max_distance": 0.5, "depth": 2 },
          { "image": [3, 4], "uv": [0.1, 0.2], "material": 3 },
          { "image": [5, 6], "vertex": 7, "mesh": "Head", "primitive": 1 },
          { "image": [7, 8], "triangle": 9, "barycentric": [0.2, 0.3, 0.5] },
          { "image": [9, 1], "ray": { "origin": [0, 0, 5], "direction": [0, 0, -1] } } ],
        "nodes": ["Body", 2], "materials": [0], "size": 1.5, "up": [0, 1, 0],
        "opacity": 0.25, "blend": "multiply", "output": "overlay", "offset": 0.01, "instance": "all",
        "method": "paper", "energy": "conformal" },
      { "name": "b", "image": "/elsewhere/b.png", "region": { "alpha": 0.25 },
        "features": [ { "image": [1, 2], "position": [1, 2, 3] } ] },
      { "name": "c", "image": "c.png", "region": { "rectangle": true },
        "features": [ { "image": [1, 2], "position": [1, 2, 3] } ] } ] })");
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->model, folder_ / "models/head.glb");
  EXPECT_EQ(job->texture_size, 512);
  EXPECT_EQ(job->seams, SeamFit::exact);
  ASSERT_EQ(job->decals.size(), 3u);

  const DecalJob& a = job->decals[0];
  EXPECT_EQ(a.image, folder_ / "a.png");
  EXPECT_TRUE(a.mirrored);
  EXPECT_EQ(std::get<ContourRegion>(a.region).contour[2].y, 20);
  ASSERT_EQ(a.features.size(), 5u);
  EXPECT_EQ(a.features[0].depth, 2);
  EXPECT_EQ(std::get<PositionPlace>(a.features[0].place).position, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<PositionPlace>(a.features[0].place).max_distance, 0.5);
  EXPECT_EQ(std::get<std::size_t>(std::get<UvPlace>(a.features[1].place).material), 3u);
  EXPECT_EQ(std::get<VertexPlace>(a.features[2].place).vertex, 7u);
  EXPECT_EQ(std::get<std::string>(std::get<VertexPlace>(a.features[2].place).mesh), "Head");
  EXPECT_EQ(std::get<VertexPlace>(a.features[2].place).primitive, 1u);
  EXPECT_EQ(std::get<TrianglePlace>(a.features[3].place).barycentric[2], 0.5);
  EXPECT_EQ(std::get<RayPlace>(a.features[4].place).direction, Vec3(0, 0, -1));
  EXPECT_EQ(std::get<std::string>(a.nodes[0]), "Body");
  EXPECT_EQ(std::get<std::size_t>(a.nodes[1]), 2u);
  EXPECT_EQ(a.size, 1.5);
  EXPECT_EQ(a.up, Vec3(0, 1, 0));
  EXPECT_EQ(a.opacity, 0.25);
  ASSERT_EQ(a.layers.size(), 1U);
  EXPECT_EQ(a.layers[0].blend, BlendMode::multiply);
  EXPECT_EQ(a.output, DecalOutput::overlay);
  EXPECT_EQ(a.instance, Instance::all);
  EXPECT_EQ(a.offset, 0.01);
  EXPECT_EQ(a.method, Method::paper);
  EXPECT_EQ(a.energy, Energy::conformal);

  EXPECT_EQ(job->decals[1].image, "/elsewhere/b.png");
  EXPECT_EQ(std::get<AlphaRegion>(job->decals[1].region).threshold, 0.25);
  EXPECT_TRUE(std::holds_alternative<RectangleRegion>(job->decals[2].region));
}

TEST_F(JobTest, EnergyMayBeANumber) {
  json valid = valid_job();
  valid["decals"][0]["energy"] = 0.25;
  const auto job = load(valid);
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->decals[0].energy, Energy{0.25});
  for (const json& wrong : {json(1.5), json(-0.1), json("stiff")}) {
    valid["decals"][0]["energy"] = wrong;
    const auto refused = load(valid);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("/decals/0/energy"), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find("conformal"), std::string::npos) << refused.error().message;
  }
}

TEST_F(JobTest, ANameGivenTwiceIsAnError) {
  const auto job = load_text(R"({"version": 1, "version": 1, "model": "m.glb", "decals": []})");
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().code, ErrorCode::json_invalid);
  EXPECT_NE(job.error().message.find("\"version\" is given twice"), std::string::npos) << job.error().message;
}

TEST_F(JobTest, LeavesOutWhatMayBeLeftOut) {
  const auto job = load(valid_job());
  ASSERT_TRUE(job) << job.error().message;
  const DecalJob& decal = job->decals[0];
  EXPECT_EQ(job->texture_size, 2048);
  EXPECT_EQ(job->unwrap, Unwrap::unseen);
  EXPECT_EQ(job->seams, SeamFit::exact);
  EXPECT_FALSE(decal.mirrored);
  EXPECT_TRUE(std::holds_alternative<AutomaticRegion>(decal.region));
  EXPECT_FALSE(std::get<PositionPlace>(decal.features[0].place).max_distance);
  EXPECT_EQ(decal.opacity, 1);
  ASSERT_EQ(decal.layers.size(), 1U);
  EXPECT_EQ(decal.layers[0].blend, BlendMode::normal);
  EXPECT_EQ(decal.output, DecalOutput::bake);
  EXPECT_EQ(decal.instance, Instance::only_this);
  EXPECT_EQ(decal.method, Method::applique);
  EXPECT_EQ(decal.energy, Energy::isometric);
}

TEST_F(JobTest, ReadsTheOptionsOfItsMethod) {
  json document = valid_job();
  document["decals"][0].update({{"method", "planar"}, {"planar", {{"depth", 0.25}}}});
  auto job = load(document);
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->decals[0].method, Method::planar);
  EXPECT_EQ(job->decals[0].planar.depth, 0.25);
  EXPECT_EQ(job->decals[0].planar.normal_limit, PlanarLimits().normal_limit);

  document["decals"][0].erase("planar");
  document["decals"][0].update({{"method", "expmap"}, {"expmap", {{"parents", "one"}}}});
  job = load(document);
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->decals[0].method, Method::expmap);
  EXPECT_EQ(job->decals[0].parents, Parents::one);

  document["decals"][0].erase("expmap");
  document["decals"][0]["method"] = "stroke";
  job = load(document);
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->decals[0].method, Method::stroke);
  EXPECT_EQ(job->decals[0].parents, Parents::upwind);
}

TEST_F(JobTest, SyntaxErrorSaysLineAndColumn) {
  const auto job = load_text(std::string("{ \"version\": 1,\n  \"model\": \"a.glb\" \"decals\" }"));
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().code, ErrorCode::json_invalid);
  EXPECT_EQ(job.error().message,
            "job.json: line 2, column 20: found '\"decals\"' where ',' or '}' is expected");
}

/// Text that is no JSON, and what is said of it.
struct BrokenText {
  const char* text;
  const char* message;
};

class JobSyntax : public JobTest, public testing::WithParamInterface<BrokenText> {};

TEST_P(JobSyntax, FaultIsSaidInOurWords) {
  const auto job = load_text(GetParam().text);
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().code, ErrorCode::json_invalid);
  EXPECT_EQ(job.error().message, std::string("job.json: ") + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    All, JobSyntax,
    testing::Values(
        BrokenText{"", "line 1, column 1: the text ends where a value is expected"},
        BrokenText{"{\n  \"a\": [1, 2 }", "line 2, column 14: found '}' where ',' or ']' is expected"},
        BrokenText{R"({"a": 1, })", "line 1, column 10: found '}' where a name in double quotes is expected"},
        BrokenText{"{\n\"a\": 1e999}", "line 2, column 6: the number 1e999 is too large"},
        BrokenText{R"({"a": "abc)", "line 1, column 7: a string has no closing quote"},
        BrokenText{R"({"a": "c:\models"})",
                   "line 1, column 7: a string has a backslash that begins no escape sequence; write it as "
                   "\\\\, or a path with /"},
        BrokenText{"{\"a\": \"\xff\"}", "line 1, column 7: a string is not UTF-8"},
        BrokenText{R"({"a" 1})", "line 1, column 6: found '1' where ':' is expected"},
        BrokenText{R"({"a": ?})", "line 1, column 7: found '?', which is no value"},
        BrokenText{R"({"a": -})", "line 1, column 7: a number is malformed"},
        BrokenText{R"({} x)", "line 1, column 4: found 'x' where the end of the text is expected"}));

TEST_F(JobTest, MissingFileAndFolderAreUnreadable) {
  for (const auto& path : {folder_ / "none.json", folder_}) {
    const auto job = load_job(path);
    ASSERT_FALSE(job);
    EXPECT_EQ(job.error().code, ErrorCode::file_unreadable);
    EXPECT_NE(job.error().message.find(path.string()), std::string::npos);
  }
}

/// One change to a valid job, and the sentence that it must bring.
struct Fault {
  const char* pointer;
  const char* value;  ///< JSON; "" removes what is there.
  const char* message;
};

class JobFault : public JobTest, public testing::WithParamInterface<Fault> {};

TEST_P(JobFault, IsNamed) {
  json job = valid_job();
  const json::json_pointer pointer(GetParam().pointer);
  if (*GetParam().value == '\0')
    job.at(pointer.parent_pointer()).erase(pointer.back());
  else
    job[pointer] = json::parse(GetParam().value);
  const auto loaded = load(job);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::schema_violation);
  EXPECT_EQ(loaded.error().message, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    All, JobFault,
    testing::Values(
        Fault{"/version", "2", "job.json: /version: found 2, expected 1, the version of the job format"},
        Fault{"/model", "",
              "job.json: the document: found no 'model', expected the path of a .glb or .gltf file, relative "
              "to the job file"},
        Fault{"/decals", "[]", "job.json: /decals: found [], expected a list of at least one decal"},
        Fault{"/decals/0/opacity", "1.7",
              "job.json: /decals/0/opacity: found 1.7, expected a number from 0 to 1"},
        Fault{"/decals/0/opacity", "\"half\"",
              "job.json: /decals/0/opacity: found \"half\", expected a number from 0 to 1"},
        Fault{"/decals/0/opactiy", "1",
              "job.json: /decals/0: found the unknown property 'opactiy', expected 'opacity'"},
        Fault{
            "/decals/0/blend", "\"dissolve\"",
            "job.json: /decals/0/blend: found \"dissolve\", expected a blend mode: normal, multiply, screen, "
            "overlay, darken, lighten, color-dodge, color-burn, hard-light, soft-light, difference, "
            "exclusion, hue, saturation, color, luminosity, add, erase"},
        Fault{"/decals/0/layers", R"({"normal": {"image": "n.png", "blend": "erase"}})",
              "job.json: /decals/0/layers/normal/blend: found \"erase\", expected a blend mode for normal "
              "maps: normal, add"},
        Fault{"/decals/0/layers", R"({"roughness": {"value": 0.5, "blend": "hue"}})",
              "job.json: /decals/0/layers/roughness/blend: found \"hue\", expected a blend mode for numbers: "
              "normal, multiply, screen, overlay, darken, lighten, color-dodge, color-burn, hard-light, "
              "soft-light, difference, exclusion, add"},
        Fault{
            "/decals/0/layers", R"({"baseColor": {"blend": "dissolve"}})",
            "job.json: /decals/0/layers/baseColor/blend: found \"dissolve\", expected a blend mode: normal, "
            "multiply, screen, overlay, darken, lighten, color-dodge, color-burn, hard-light, soft-light, "
            "difference, exclusion, hue, saturation, color, luminosity, add, erase"},
        Fault{
            "/decals/0/energy", "\"angles\"",
            "job.json: /decals/0/energy: found \"angles\", expected \"isometric\" (keeps lengths, the "
            "default), \"conformal\" (keeps angles only), or a number between: 1 is isometric, 0 conformal"},
        Fault{"/decals/0/layers", R"({"baseColor": false})",
              "job.json: /decals/0/layers: found no layer beside \"baseColor\": false on decal 'tiger', of "
              "which nothing would be seen, expected a layer"},
        Fault{
            "/decals/0/method", "\"lscm\"",
            "job.json: /decals/0/method: found \"lscm\", expected \"applique\", \"paper\" (the paper's own "
            "algorithm, for comparison), \"planar\", \"expmap\" or \"stroke\" (simpler maps, which meet one "
            "feature only)"},
        Fault{"/decals/0/planar", R"({"depth": 1})",
              "job.json: /decals/0/planar: found options of the method \"planar\" on decal 'tiger', whose "
              "method "
              "is \"applique\", expected \"method\": \"planar\" beside them"},
        Fault{"/decals/0/expmap", R"({"parents": "one"})",
              "job.json: /decals/0/expmap: found options of the method \"expmap\" on decal 'tiger', whose "
              "method "
              "is \"applique\", expected \"method\": \"expmap\" beside them"},
        Fault{"/decals/0/expmap", R"({"parents": "two"})",
              "job.json: /decals/0/expmap/parents: found \"two\", expected \"one\" or \"upwind\", the "
              "neighbours "
              "that a vertex takes its place from: the one on the shortest path, or all that are nearer "
              "(default)"},
        Fault{
            "/decals/0/size", "0",
            "job.json: /decals/0/size: found 0, expected a number over 0, the image's width in scene units"},
        Fault{"/decals/0/up", "[0, 0, 0]",
              "job.json: /decals/0/up: found [0,0,0], expected three numbers [x, y, z], not all 0, in scene "
              "space"},
        Fault{"/decals/0/region", "{}",
              "job.json: /decals/0/region: found none, expected exactly one of contour, alpha, rectangle"},
        Fault{"/decals/0/region", R"({"alpha": 0.5, "rectangle": true})",
              "job.json: /decals/0/region: found alpha and rectangle, expected exactly one of contour, "
              "alpha, rectangle"},
        Fault{"/decals/0/features", "[]",
              "job.json: /decals/0/features: found [], expected a list of at least one feature"},
        Fault{
            "/decals/0/instance", "\"some\"",
            "job.json: /decals/0/instance: found \"some\", expected \"this\" (default) or \"all\", whether a "
            "baked decal is seen where it lies only or on every node that shows the mesh"},
        Fault{"/decals/0/features/0/image", "[1, 2, 3]",
              "job.json: /decals/0/features/0/image: found [1,2,3], expected two numbers [x, y], in pixels "
              "from the image's top-left corner, y down"},
        Fault{"/decals/0/features/0/image/1", "null",
              "job.json: /decals/0/features/0/image/1: found null, expected a number of pixels"},
        Fault{"/decals/0/features/0/position", "",
              "job.json: /decals/0/features/0: found no place on the model, expected exactly one of "
              "position, uv, vertex, triangle, ray"},
        Fault{"/decals/0/features/0/vertex", "3",
              "job.json: /decals/0/features/0: found position and vertex, expected exactly one of position, "
              "uv, vertex, triangle, ray"},
        Fault{"/decals/0/features/1/material", "",
              "job.json: /decals/0/features/1: found 'uv' without 'material', expected 'material' beside it"},
        Fault{"/decals/0/features/1/max_distance", "1",
              "job.json: /decals/0/features/1: found 'max_distance' without 'position', expected 'position' "
              "beside it"}));

TEST_F(JobTest, TellsEveryFaultAtOnce) {
  json job = valid_job();
  job["decals"][0]["opacity"] = -1;
  job["decals"][0]["features"][1]["uv"] = "here";
  const std::string message = message_of(job);
  EXPECT_NE(message.find("/decals/0/opacity: found -1"), std::string::npos) << message;
  EXPECT_NE(message.find("/decals/0/features/1/uv: found \"here\""), std::string::npos) << message;
}

TEST_F(JobTest, AnOverlayHasAColour) {
  json job = valid_job();
  job["decals"][0]["layers"] = {{"baseColor", false}, {"roughness", 0.5}};
  EXPECT_TRUE(load(job));
  job["decals"][0]["output"] = "overlay";
  EXPECT_EQ(message_of(job),
            "job.json: /decals/0/layers/baseColor: found false on the overlay 'tiger', which lies over the "
            "surface and cannot leave its colour in place, expected a base colour, or \"output\": \"bake\"");
}

TEST_F(JobTest, DecalsHaveNamesOfTheirOwn) {
  json job = valid_job();
  job["decals"].push_back(job["decals"][0]);
  EXPECT_EQ(message_of(job),
            "job.json: /decals/1/name: found \"tiger\", the name of /decals/0 too, expected a name of its "
            "own for each "
            "decal");
}

TEST(Schema, EveryPlaceIsDescribed) {
  // What an error expects is read from the descriptions, so none may be missing, nor in a choice.
  for (const json& schema : {job_schema(), report_schema()}) {
    const std::function<void(const json&, const std::string&)> check = [&](const json& node,
                                                                           const std::string& at) {
      if (node.contains("properties"))
        for (const auto& property : node["properties"].items()) {
          const std::string place = at + "/" + property.key();
          const bool reference = property.value().contains("$ref");
          EXPECT_TRUE(reference || property.value().contains("description")) << place;
          check(property.value(), place);
        }
      if (node.contains("items") && node["items"].is_object()) check(node["items"], at + "/items");
      for (const char* choices : {"anyOf", "oneOf"})
        for (const json& choice : node.value(choices, json::array())) check(choice, at + "/" + choices);
    };
    check(schema, "");
    for (const auto& definition : schema["definitions"].items()) {
      EXPECT_TRUE(definition.value().contains("description")) << definition.key();
      check(definition.value(), definition.key());
    }
  }
}

}  // namespace
