// What `applique explain` draws: every stage of a small job, looked at for the colours that it must show.

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "applique/image/image.h"

#include "cli/command.h"
#include "cli/small_model.h"
#include "explain/palette.h"

using namespace applique;
using nlohmann::json;

namespace {

/// Of a line one pixel wide and as long as the tree is in the smallest panel, discs left out: 370 of 800 x
/// 400.
constexpr double line_share = 0.001;

/// A grey image with five features, on a plane where one of them is moved.
class ExplainTest : public testing::Test {
 protected:
  void SetUp() override {
    write_small_model(folder_ / "model.glb", {make_plane("Plane", 12)},
                      {{"paint", std::nullopt, {1, 1, 1, 1}}});
    Image image = make_image(64, 64, {0x8000, 0x8000, 0x8000, 0xffff});
    image.channels = 3;
    write_png(folder_ / "image.png", image);
    write_job("applique");
  }

  void write_job(const std::string& method) {
    const auto feature = [](double x, double y, double dx) {
      return json{{"image", {x, y}}, {"position", {(x - 32) / 64 + dx, (32 - y) / 64, 0}}};
    };
    folder_.write(
        "job.json",
        {{"version", 1},
         {"model", "model.glb"},
         {"decals",
          json::array({{{"name", "crest"},
                        {"image", "image.png"},
                        {"method", method},
                        {"guide", false},  // leaves the warp something to do
                        {"features", json::array({feature(10, 10, 0), feature(54, 10, 0), feature(54, 54, 0),
                                                  feature(10, 54, 0), feature(32, 32, 0.08)})}}})}});
  }

  /// The share of the picture's pixels whose colour is within `tolerance` of this one in each channel.
  static double share_of(const Image& picture, const draw::Rgba& colour, double tolerance = 0.05) {
    std::size_t count = 0;
    const std::array<double, 3> wanted = {colour.r, colour.g, colour.b};
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        bool like = true;
        for (std::size_t c = 0; c < 3; ++c)
          like = like && std::abs(picture.pixel(x, y)[c] / 65535.0 - wanted[c]) < tolerance;
        count += like ? 1 : 0;
      }
    return static_cast<double>(count) / (static_cast<double>(picture.width) * picture.height);
  }

  Image explain(const std::string& arguments) {
    const CommandResult result =
        folder_.run("explain job.json -o picture.png --size 800x400 --stage " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    auto picture = read_image(folder_ / "picture.png");
    EXPECT_TRUE(picture);
    if (!picture) return make_image(1, 1, {0, 0, 0, 0});
    EXPECT_EQ(picture->width, 800);
    EXPECT_EQ(picture->height, 400);
    EXPECT_GT(share_of(*picture, palette::white), 0.02) << "the background";
    return *std::move(picture);
  }

  CommandFolder folder_;
};

TEST_F(ExplainTest, DrawsTheContourAndTheFeatures) {
  for (const char* stage : {"region", "graph", "warp", "growth"}) {
    const Image picture = explain(stage);
    EXPECT_GT(share_of(picture, palette::vermilion), line_share) << stage;
    EXPECT_GT(share_of(picture, palette::ink), line_share) << stage;
  }
}

TEST_F(ExplainTest, DrawsTheGraphAndItsTree) {
  const Image graph = explain("graph");
  EXPECT_GT(share_of(graph, palette::green), line_share);
  EXPECT_GT(share_of(graph, palette::blue), line_share);
  EXPECT_GT(share_of(explain("paths"), palette::blue), line_share);
}

/// A convex region has one group, which moves all of it.
TEST_F(ExplainTest, DrawsTheInfluenceOfTheGroups) {
  const Image picture = explain("influence");
  EXPECT_GT(share_of(picture, palette::vermilion), line_share);
  EXPECT_GT(share_of(picture, draw::mix(palette::white, palette::group(0), 0.7)), 0.5);
}

TEST_F(ExplainTest, DrawsThePatchOnTheModelAndFlat) {
  const draw::Rgba inside = draw::mix(palette::white, palette::sky, 0.45);
  EXPECT_GT(share_of(explain("seed"), inside), 0.02);
  EXPECT_GT(share_of(explain("growth"), inside), 0.1);
  const auto bluish = [](const Image& picture) {
    std::size_t count = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width / 2; ++x) {
        const std::uint16_t* p = picture.pixel(x, y);
        count += p[2] > p[0] + 0x1000 ? 1 : 0;
      }
    return count;
  };
  EXPECT_GT(bluish(explain("patch")), 2000u) << "the lit patch on the model, in the left half";
}

/// The moved feature enlarges the image on its one side and shrinks it on the other.
TEST_F(ExplainTest, PaintsTheDistortion) {
  const Image picture = explain("distortion");
  EXPECT_GT(share_of(picture, ramp_colour(palette::diverging, 0.25), 0.1), 0.005) << "shrunk";
  EXPECT_GT(share_of(picture, ramp_colour(palette::diverging, 0.75), 0.1), 0.005) << "enlarged";
  EXPECT_GT(share_of(picture, ramp_colour(palette::rising, 0.5), 0.1), 0.005) << "sheared";
  EXPECT_EQ(share_of(picture, palette::flipped, 0.02), 0) << "turned over";
}

TEST_F(ExplainTest, StepsOfTheGrowthDiffer) {
  const Image first = explain("growth --step 0"), second = explain("growth --step 1");
  EXPECT_NE(first.rgba, second.rgba);
}

TEST_F(ExplainTest, DrawsThePapersMethodToo) {
  write_job("paper");
  for (const char* stage :
       {"region", "graph", "paths", "seed", "growth", "warp", "influence", "patch", "distortion"})
    EXPECT_LT(share_of(explain(stage), palette::white), 0.99) << stage;
}

TEST_F(ExplainTest, DrawsWhatTheRivalsHaveOfAMap) {
  write_job("planar");
  EXPECT_LT(share_of(explain("growth"), palette::white), 0.99);
  const double pairs = share_of(explain("paths"), palette::blue);
  write_job("expmap");
  for (const char* stage : {"seed", "warp", "patch"})
    EXPECT_LT(share_of(explain(stage), palette::white), 0.99) << stage;
  write_job("stroke");
  EXPECT_GT(share_of(explain("paths"), palette::blue), pairs + 0.2 * line_share)
      << "the curve, on the model alone";
}

TEST_F(ExplainTest, TurnsDownWhatIsNotThere) {
  const auto run = [&](const std::string& arguments) {
    return folder_.run("explain job.json -o picture.png " + arguments);
  };
  EXPECT_EQ(run("--stage dreams").status, 1);
  EXPECT_EQ(run("").status, 1);
  const CommandResult before = run("--stage growth --step -1");
  EXPECT_EQ(before.status, 1);
  EXPECT_NE(before.err.find("--step: -1: expected a whole number from 0"), std::string::npos) << before.err;
  EXPECT_EQ(folder_.run("explain job.json --stage region -o picture.jpg").status, 1);
  EXPECT_EQ(run("--stage region --step 1").status, 1);
  EXPECT_EQ(run("--stage region --size 0x5").status, 1);
  const CommandResult late = run("--stage growth --step 1000");
  EXPECT_EQ(late.status, 1);
  EXPECT_NE(late.err.find("no step 1000"), std::string::npos) << late.err;
  EXPECT_EQ(run("--stage region --decal nobody").status, 2);
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"image.png", "job.json", "model.glb"}));
}

}  // namespace
