#include "cli/uv_conflict.h"

#include <algorithm>
#include <cmath>

#include "cli/same_look.h"
#include "gltf/validator.h"
#include "schema.h"

namespace applique {

using nlohmann::json;

namespace {

constexpr std::array<std::uint16_t, 4> red = {0xffff, 0, 0, 0xffff};

}  // namespace

SmallMesh make_box() {
  SmallMesh box;
  box.name = "Box";
  const SmallMesh face = make_plane("Face", 8);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto base = static_cast<std::uint32_t>(box.positions.size());
      for (const Vec3& place : face.positions) {
        Vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = place.x() * side;
        p[(axis + 2) % 3] = place.y();
        box.positions.push_back(p);
      }
      box.uvs.insert(box.uvs.end(), face.uvs.begin(), face.uvs.end());
      for (const auto& t : face.triangles) box.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    }
  return box;
}

SmallMesh make_mirrored_wall() {
  SmallMesh wall = make_plane("Wall", 8);
  for (std::size_t i = 0; i < wall.positions.size(); ++i) {
    const double x = wall.positions[i].x();
    wall.positions[i].x() = 2 * x;
    wall.uvs[i][0] = 1 - std::abs(x);
  }
  return wall;
}

bool is_red(const std::array<double, 4>& colour) {
  return colour[0] > 253 && colour[1] < 2 && colour[2] < 2;
}

void UvConflictTest::SetUp() {
  Image image = make_image(image_size, image_size, red);
  image.channels = 3;
  write_png(folder_ / "image.png", image);
}

void UvConflictTest::write_model(const std::vector<SmallMesh>& meshes, int texture_size) {
  write_small_model(
      folder_ / "model.glb", meshes,
      {{"paint", make_noise(texture_size), {1, 1, 1, 1}}, {"plain", std::nullopt, {0.5, 0.25, 1, 1}}});
}

json UvConflictTest::job_at(double x, double y) {
  const json ray = {{"origin", {x, y, 20}}, {"direction", {0, 0, -1}}};
  return {{"version", 1},
          {"model", "model.glb"},
          {"texture_size", 256},
          {"decals", json::array({{{"name", "crest"},
                                   {"image", "image.png"},
                                   {"size", 1},
                                   {"up", {0, 1, 0}},
                                   {"features", {{{"image", {32, 32}}, {"ray", ray}}}}}})}};
}

json UvConflictTest::read_report() {
  json report = json::parse(folder_.read("report.json"));
  const auto valid = check_schema(report, report_schema(), "report.json");
  EXPECT_TRUE(valid) << valid.error().message;
  return report;
}

json UvConflictTest::bake(const json& job, const std::string& output, const std::string& options) {
  folder_.write("job.json", job);
  const CommandResult result = folder_.run("bake job.json --report report.json -o " + output + " " + options);
  EXPECT_EQ(result.status, 0) << result.err;
  return result.status == 0 ? read_report() : json();
}

void UvConflictTest::expect_same_look(json job) {
  for (json& decal : job["decals"]) decal["opacity"] = 0;
  const json report = bake(job, "unseen.glb");
  ASSERT_TRUE(report.is_object());
  ASSERT_EQ(report["decals"][0]["warnings"].size(), 1u) << report["decals"][0]["warnings"];
  EXPECT_EQ(report["decals"][0]["warnings"][0]["code"], "invisible");
  EXPECT_GT(report["textures"][0]["separated_triangles"], 0);
  EXPECT_EQ(report["textures"][0]["shared_texels"], 0);
  const Model before = load("model.glb");
  const Model after = load("unseen.glb");
  const LookDifference difference = compare_looks(before, after);
  std::size_t triangles = 0;
  for (const ModelPart& part : before.parts) triangles += part.triangles.size();
  EXPECT_EQ(difference.triangles, triangles);
  EXPECT_EQ(difference.missing, 0u);
  EXPECT_LT(difference.largest, 2);
}

namespace {

/// The most that two pictures differ, in steps of 1/255.
double largest_difference(const Image& a, const Image& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    largest = std::max(largest, std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  return largest / 257.0;
}

}  // namespace

double UvConflictTest::picture_difference(const std::string& before, const std::string& after, int azimuth) {
  Image pictures[2];
  for (int i = 0; i < 2; ++i) {
    const std::string& name = i == 0 ? before : after;
    const CommandResult result = folder_.run("render " + name + " -o picture.png --size 400x300 --azimuth " +
                                             std::to_string(azimuth) + " --elevation 0");
    EXPECT_EQ(result.status, 0) << result.err;
    pictures[i] = read_image(folder_ / "picture.png").value();
  }
  return largest_difference(pictures[0], pictures[1]);
}

Image UvConflictTest::close_up(json job, bool separated, const std::string& model) {
  // An overlay of nothing leaves the model as it was, before the same camera.
  for (json& decal : job["decals"])
    decal.update({{"opacity", 0}, {"output", separated ? "bake" : "overlay"}});
  job["model"] = model;
  bake(job, "close_up.glb", "--preview close_up.png");
  return read_image(folder_ / "close_up.png").value();
}

double UvConflictTest::share_that_differs(const Image& a, const Image& b) {
  constexpr int most = 2 * 257;
  std::size_t over = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) over += std::abs(int{a.rgba[i]} - int{b.rgba[i]}) > most;
  return static_cast<double>(over) / static_cast<double>(a.rgba.size());
}

void UvConflictTest::expect_valid(const std::string& output) {
  const auto counts = validate({folder_ / "model.glb", folder_ / output});
  if (!counts) return;  // The validator is not installed; CI has it.
  for (const auto& [code, count] : (*counts)[1])
    EXPECT_TRUE((*counts)[0].contains(code)) << output << ": " << code;
}

}  // namespace applique
