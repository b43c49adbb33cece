#include "images.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bottle.h"
#include "bust.h"
#include "jobs.h"

namespace applique::assets {
namespace {

double share_of_alpha(const Image& image, std::uint16_t low, std::uint16_t high) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] >= low && image.rgba[i] <= high) ++count;
  return 4.0 * static_cast<double>(count) / static_cast<double>(image.rgba.size());
}

TEST(Mask, HasItsSizeSoftEdgesAndOpenEyes) {
  const Image mask = draw_mask();
  ASSERT_EQ(mask.width, 1024);
  ASSERT_EQ(mask.height, 1024);
  ASSERT_EQ(mask.channels, 4);
  EXPECT_GT(share_of_alpha(mask, 65535, 65535), 0.5);
  EXPECT_GT(share_of_alpha(mask, 0, 0), 0.2);
  EXPECT_GT(share_of_alpha(mask, 1, 65534), 0.001);
  EXPECT_LT(share_of_alpha(mask, 1, 65534), 0.02);
  for (const int x : {690, 1024 - 690}) EXPECT_EQ(mask.pixel(x, 425)[3], 0) << "the eye is not open";
  // The outline stays off the image's sides.
  for (int i = 0; i < 1024; ++i) {
    EXPECT_EQ(mask.pixel(i, 0)[3], 0);
    EXPECT_EQ(mask.pixel(i, 1023)[3], 0);
    EXPECT_EQ(mask.pixel(0, i)[3], 0);
    EXPECT_EQ(mask.pixel(1023, i)[3], 0);
  }
}

TEST(Emblem, HasItsSizeAndTransparency) {
  const Image emblem = draw_emblem();
  ASSERT_EQ(emblem.width, 768);
  ASSERT_EQ(emblem.height, 768);
  EXPECT_GT(share_of_alpha(emblem, 65535, 65535), 0.3);
  EXPECT_GT(share_of_alpha(emblem, 0, 0), 0.2);
}

TEST(Label, IsOpaqueButForItsCorners) {
  const Image label = draw_label();
  ASSERT_EQ(label.width, 1024);
  ASSERT_EQ(label.height, 512);
  EXPECT_GT(share_of_alpha(label, 65535, 65535), 0.95);
  EXPECT_EQ(label.pixel(5, 5)[3], 0);
  EXPECT_EQ(label.pixel(1018, 506)[3], 0);
}

/// Every feature of the three jobs lies on its model's surface and, in the image, on or inside the picture.
TEST(Jobs, PinThePicturesToTheSurfaces) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "applique_assets_jobs";
  std::filesystem::create_directories(folder);
  ASSERT_TRUE(write_jobs(folder));
  const auto read = [&](const char* name) { return nlohmann::json::parse(std::ifstream(folder / name)); };
  for (const char* name : {"bust-mask.json", "bust-emblem.json", "bottle-label.json"}) {
    const nlohmann::json job = read(name);
    EXPECT_EQ(job.at("version"), 1);
    const nlohmann::json& decal = job.at("decals").at(0);
    EXPECT_GE(decal.at("features").size(), 2U);
    for (const nlohmann::json& feature : decal.at("features")) {
      const auto position = feature.at("position").get<std::array<double, 3>>();
      const Vec3 p(position[0], position[1], position[2]);
      const bool on_bust = job.at("model") == "bust.glb";
      EXPECT_NEAR(on_bust ? bust_distance(p) : std::hypot(p.x(), p.z()) - bottle_radius, 0, 1e-4);
    }
  }
  // The label is as wide on the bottle as in its image, and lies across the seam at x = 0, z > 0.
  const nlohmann::json label = read("bottle-label.json").at("decals").at(0).at("features");
  EXPECT_LT(label.at(0).at("position").at(0).get<double>(), 0);
  EXPECT_GT(label.at(1).at("position").at(0).get<double>(), 0);
  EXPECT_GT(label.at(2).at("position").at(2).get<double>(), 0);
}

}  // namespace
}  // namespace applique::assets
