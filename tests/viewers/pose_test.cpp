// Overlays on third-party models, posed by three.js: they follow the surface.

#include <cstdio>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "gltf/test_models.h"
#include "models/largest_piece.h"

namespace applique {
namespace {

using nlohmann::json;

constexpr int image_size = 64;

/// What tests/viewers/pose.mjs measures on a model.
json pose(const std::filesystem::path& model) {
  const std::string command = "node '" APPLIQUE_VIEWER_SCRIPTS "/pose.mjs' '" APPLIQUE_NODE_MODULES
                              "/three' '" +
                              model.string() + "'";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get()))
    text.push_back(static_cast<char>(c));
  return json::parse(text, nullptr, false);
}

struct Case {
  const char* name;
  const char* file;
  double larger;                 ///< Times the size that would fit on the model's largest smooth piece.
  std::vector<double> position;  ///< There instead, if given, the image upright.
};

void PrintTo(const Case& item, std::ostream* out) {
  *out << item.name;
}

class Posed : public testing::TestWithParam<Case> {
 protected:
  /// Bakes an overlay at a distance from the surface, and poses it.
  json bake_and_pose(double offset) {
    const auto path = test_data() / "gltf" / GetParam().file;
    const Model model = load_model(path).value();
    DecalPlace place = find_place(model);
    place.size *= GetParam().larger;
    if (const auto& p = GetParam().position; !p.empty()) {
      place.position = {p[0], p[1], p[2]};
      place.up = {0, 1, 0};
    }
    write_png(folder_ / "image.png", make_noise(image_size));
    folder_.write("job.json", job_at(place, path, folder_ / "image.png", image_size,
                                     {{"output", "overlay"}, {"offset", offset * model.diagonal()}}));
    const CommandResult result = folder_.run("-q bake job.json -o out.glb");
    EXPECT_EQ(result.status, 0) << result.err;
    return pose(folder_ / "out.glb");
  }

  void SetUp() override {
    if (test_data().empty()) GTEST_SKIP() << no_test_data;
    if (!std::filesystem::exists(APPLIQUE_NODE_MODULES "/three"))
      GTEST_SKIP() << "three.js is not installed (./dev test installs it)";
  }

  CommandFolder folder_;
};

TEST_P(Posed, EveryVertexKeepsToItsPlaceOnTheSurface) {
  const json measured = bake_and_pose(0);
  ASSERT_TRUE(measured.is_object());
  EXPECT_GE(measured["poses"], 8);
  EXPECT_GT(measured["vertices"], 8);
  EXPECT_GT(measured["moved"], 0.005) << "the animation moves the decal";
  EXPECT_LT(measured["rest"], 1e-6);
  EXPECT_LT(measured["strayed"], 1e-6);
}

TEST_P(Posed, ItStaysAboveTheSurface) {
  const json measured = bake_and_pose(0.0005);
  ASSERT_TRUE(measured.is_object());
  // At creases, and where a morph target turns the surface over, the way out is not the same at each pose.
  EXPECT_LT(measured["sunk"], 0.1);
  EXPECT_LT(measured["strayed99"], 0.002);
}

INSTANTIATE_TEST_SUITE_P(
    Models, Posed,
    testing::Values(Case{"CesiumMan", "CesiumMan.glb", 3, {}}, Case{"Fox", "Fox.glb", 3, {}},
                    Case{"RiggedFigure", "RiggedFigure.glb", 4, {}},
                    Case{"lumberjack", "lumberjack.glb", 3, {}},
                    Case{"MorphStressTest", "MorphStressTest.gltf", 0.3, {-1.75, 0.4, 0.25}},
                    Case{"AnimatedMorphSphere", "AnimatedMorphSphere.glb", 1, {}},
                    Case{"kenney", "kenney_character/character.glb", 1, {}}),
    [](const auto& item) { return std::string(item.param.name); });

}  // namespace
}  // namespace applique
