// Overlays on models that move: the model is posed by editing the written file, and every vertex of the
// overlay is still on the surface.

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "applique/surface/surface_query.h"

#include "binary_edit.h"
#include "cli/command.h"
#include "cli/small_model.h"
#include "model.h"
#include "save_document.h"

using namespace applique;
using nlohmann::json;

namespace {

constexpr int cells = 4;
constexpr int image_size = 256;

template <class T>
std::size_t add_accessor(Document& document, const std::vector<T>& items, int component, const char* type,
                         std::size_t count) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(items.data());
  const std::size_t view = add_buffer_view(document, {bytes, items.size() * sizeof(T)});
  auto& accessors = document.json["accessors"];
  accessors.push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  return accessors.size() - 1;
}

/// A flag on a skin of two joints: the right one takes over from left to right.
void add_skin(Document& document, const SmallMesh& plane) {
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (const Vec3& p : plane.positions) {
    const auto right = static_cast<float>(0.5 * (p.x() + 1));
    joints.insert(joints.end(), {0, std::uint8_t(right > 0 ? 1 : 0), 0, 0});
    weights.insert(weights.end(), {1 - right, right, 0, 0});
  }
  const std::size_t count = plane.positions.size();
  auto& attributes = document.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = add_accessor(document, joints, 5121, "VEC4", count);
  attributes["WEIGHTS_0"] = add_accessor(document, weights, 5126, "VEC4", count);
  document.json["nodes"].push_back({{"name", "left"}});
  document.json["nodes"].push_back({{"name", "right"}});
  document.json["scenes"][0]["nodes"] = {0, 1, 2};
  document.json["skins"] = {{{"joints", {1, 2}}}};
  document.json["nodes"][0]["skin"] = 0;
}

/// Six joints in two sets, on a node that mirrors.
void add_mirrored_skin(Document& document, const SmallMesh& plane) {
  constexpr std::size_t joints = 6, slots = 8;
  std::vector<std::uint8_t> index[2];
  std::vector<float> weight[2];
  for (const Vec3& p : plane.positions) {
    std::array<double, slots> shares = {};
    double sum = 0;
    for (std::size_t j = 0; j < joints; ++j) {
      const double away = p.x() - (-1 + 2.0 * double(j) / (joints - 1));
      sum += shares[j] = std::exp(-2 * away * away);
    }
    for (std::size_t j = 0; j < slots; ++j) {
      index[j / 4].push_back(j < joints ? static_cast<std::uint8_t>(j) : 0);
      weight[j / 4].push_back(static_cast<float>(shares[j] / sum));
    }
  }
  const std::size_t count = plane.positions.size();
  auto& attributes = document.json["meshes"][0]["primitives"][0]["attributes"];
  for (const int set : {0, 1}) {
    attributes["JOINTS_" + std::to_string(set)] = add_accessor(document, index[set], 5121, "VEC4", count);
    attributes["WEIGHTS_" + std::to_string(set)] = add_accessor(document, weight[set], 5126, "VEC4", count);
  }
  Document::Json nodes = {0};
  Document::Json list = Document::Json::array();
  for (std::size_t j = 1; j <= joints; ++j) {
    document.json["nodes"].push_back({{"name", "joint"}});
    nodes.push_back(j);
    list.push_back(j);
  }
  document.json["scenes"][0]["nodes"] = nodes;
  document.json["skins"] = {{{"joints", list}}};
  document.json["nodes"][0]["skin"] = 0;
  document.json["nodes"][0]["scale"] = {-1, 1, 1};
}

/// A hill as a morph target, with an animation that raises it.
void add_hill(Document& document, const SmallMesh& plane) {
  std::vector<float> moves;
  for (const Vec3& p : plane.positions)
    moves.insert(moves.end(), {0, 0, static_cast<float>(1 - p.x() * p.x())});
  const std::size_t target = add_accessor(document, moves, 5126, "VEC3", plane.positions.size());
  document.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  document.json["meshes"][0]["weights"] = {0.25};
  document.json["meshes"][0]["extras"]["targetNames"] = {"hill"};
  const std::size_t times = add_accessor(document, std::vector<float>{0, 1}, 5126, "SCALAR", 2);
  const std::size_t heights = add_accessor(document, std::vector<float>{0, 1}, 5126, "SCALAR", 2);
  document.json["accessors"][times].update({{"min", {0}}, {"max", {1}}});
  document.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", heights}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
}

/// Squares of four colours.
Image make_squares(int size) {
  Image image = make_image(size, size, {0, 0, 0, 0xffff});
  image.channels = 3;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      image.pixel(x, y)[0] = 8 * x / size % 2 == 0 ? 0xffff : 0x4000;
      image.pixel(x, y)[1] = 8 * y / size % 2 == 0 ? 0xffff : 0x4000;
    }
  return image;
}

bool is_overlay(const Document& document, std::size_t node) {
  return find(document.json["nodes"][node], {"extras", "applique", "decal"}) != nullptr;
}

std::vector<std::size_t> overlays_of(const Document& document) {
  std::vector<std::size_t> nodes;
  for (std::size_t n = 0; n < count_of(document, "nodes"); ++n)
    if (is_overlay(document, n)) nodes.push_back(n);
  return nodes;
}

/// How far the overlays' vertices are from the model's own surface; and their number.
std::pair<double, std::size_t> distance_from_surface(const Document& document) {
  const auto model = decode_model(document);
  EXPECT_TRUE(model) << model.error().message;
  std::vector<std::size_t> own;
  for (std::size_t n = 0; n < count_of(document, "nodes"); ++n)
    if (!is_overlay(document, n)) own.push_back(n);
  const ModelSurface surface = build_surface(*model, own);
  const SurfaceQuery query(surface.mesh);
  double farthest = 0;
  std::size_t vertices = 0;
  for (const ModelPart& part : model->parts) {
    if (!is_overlay(document, part.node)) continue;
    for (const Vec3& p : part.positions)
      farthest = std::max(farthest, (position_of(surface.mesh, query.nearest(p)) - p).norm());
    vertices += part.positions.size();
  }
  return {farthest, vertices};
}

Document::Json turn_about_y(double degrees) {
  const double half = 0.5 * degrees * std::numbers::pi / 180;
  return {0, std::sin(half), 0, std::cos(half)};
}

class OverlayMotion : public testing::Test {
 protected:
  /// Writes a model of one plane, changed by `change`.
  template <class Change>
  void write_model(const Change& change) {
    const SmallMesh plane = make_plane("Plane", cells);
    write_small_model(folder_ / "plane.glb", {plane}, {{"paint", std::nullopt, {1, 1, 1, 1}}});
    Document document = load_document(folder_ / "plane.glb").value();
    change(document, plane);
    ASSERT_TRUE(save_document(document, folder_ / "model.glb"));
    write_png(folder_ / "image.png", make_squares(image_size));
  }

  /// Bakes the overlay, bent so that no similarity fits; `offset` above the surface.
  Document bake(double offset = 0, const std::string& arguments = "", bool mirrored = false) {
    const auto pin = [](double x, double y, double px, double py) {
      return json(
          {{"image", {x * image_size, y * image_size}}, {"position", {px, py, 0}}, {"max_distance", 1}});
    };
    folder_.write("job.json",
                  {{"version", 1},
                   {"model", "model.glb"},
                   {"decals",
                    {{{"name", "flag"},
                      {"image", "image.png"},
                      {"output", "overlay"},
                      {"energy", "conformal"},
                      {"offset", offset},
                      {"mirrored", mirrored},
                      {"features",
                       {pin(0.25, 0.25, -0.5, 0.4), pin(0.75, 0.25, 0.45, 0.35), pin(0.5, 0.5, 0.08, -0.03),
                        pin(0.25, 0.75, -0.4, -0.4), pin(0.75, 0.75, 0.4, -0.5)}}}}}});
    const CommandResult result = folder_.run("-q bake job.json -o out.glb --report report.json " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(json::parse(folder_.read("report.json"))["decals"][0]["warnings"], json::array());
    return load_document(folder_ / "out.glb").value();
  }

  CommandFolder folder_;
};

TEST_F(OverlayMotion, FollowsASkin) {
  write_model(add_skin);
  Document document = bake();
  const auto overlays = overlays_of(document);
  ASSERT_EQ(overlays.size(), 1u);
  const auto& node = document.json["nodes"][overlays[0]];
  EXPECT_EQ(node["skin"], 0);
  EXPECT_TRUE(document.json["scenes"][0]["nodes"].back() == overlays[0]) << "a skinned mesh is a root";
  EXPECT_LT(distance_from_surface(document).first, 1e-6);
  for (const double degrees : {40.0, 90.0, -70.0}) {
    document.json["nodes"][2]["rotation"] = turn_about_y(degrees);
    document.json["nodes"][2]["translation"] = {0.1, 0.2, 0.3};
    const auto [distance, vertices] = distance_from_surface(document);
    EXPECT_LT(distance, 1e-6);
    EXPECT_GT(vertices, 8u);
  }
}

TEST_F(OverlayMotion, FollowsManyJointsOnAMirroredNode) {
  write_model(add_mirrored_skin);
  // Seen from behind, where the outside is.
  Document document = bake(0, "", true);
  const auto overlays = overlays_of(document);
  ASSERT_EQ(overlays.size(), 1u);
  const auto mesh = document.json["nodes"][overlays[0]]["mesh"].get<std::size_t>();
  const auto& attributes = document.json["meshes"][mesh]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("JOINTS_1"));
  EXPECT_FALSE(attributes.contains("JOINTS_2"));
  EXPECT_LT(distance_from_surface(document).first, 1e-6);
  const Model rest = decode_model(document).value();
  for (const ModelPart& part : rest.parts)
    for (const auto& t : part.triangles)
      EXPECT_LT((part.positions[t[1]] - part.positions[t[0]])
                    .cross(part.positions[t[2]] - part.positions[t[0]])
                    .z(),
                0);
  for (const std::size_t joint : {2, 4, 6}) {
    document.json["nodes"][joint]["rotation"] = turn_about_y(10.0 * double(joint));
    EXPECT_LT(distance_from_surface(document).first, 1e-6);
  }
}

TEST_F(OverlayMotion, OnASkinLooksAsOnAStillModel) {
  const auto nothing = [](Document&, const SmallMesh&) {};
  write_model(nothing);
  bake(0.01, "--preview still.png");
  write_model(add_skin);
  bake(0.01, "--preview skin.png");
  const Image still = read_image(folder_ / "still.png").value();
  const Image skin = read_image(folder_ / "skin.png").value();
  ASSERT_EQ(still.rgba.size(), skin.rgba.size());
  double difference = 0, contrast = 0;
  const std::uint16_t* background = still.pixel(0, 0);
  for (std::size_t i = 0; i < still.rgba.size(); ++i) {
    difference += std::abs(double(still.rgba[i]) - skin.rgba[i]);
    contrast += std::abs(double(still.rgba[i]) - background[i % 4]);
  }
  EXPECT_LT(difference, 0.03 * contrast);
}

TEST_F(OverlayMotion, FollowsMorphTargets) {
  write_model(add_hill);
  Document document = bake();
  const auto overlays = overlays_of(document);
  ASSERT_EQ(overlays.size(), 1u);
  EXPECT_EQ(document.json["nodes"][0]["children"], Document::Json({overlays[0]}));
  const auto mesh = document.json["nodes"][overlays[0]]["mesh"].get<std::size_t>();
  EXPECT_EQ(document.json["meshes"][mesh]["extras"]["targetNames"][0], "hill");
  const auto& channels = document.json["animations"][0]["channels"];
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[1]["target"]["node"], overlays[0]);
  EXPECT_EQ(channels[1]["sampler"], channels[0]["sampler"]);
  EXPECT_LT(distance_from_surface(document).first, 1e-6) << "at rest a quarter of the hill stands";
  for (const double weight : {0.0, 0.6, 1.0}) {
    for (const std::size_t m : {std::size_t{0}, mesh}) document.json["meshes"][m]["weights"] = {weight};
    EXPECT_LT(distance_from_surface(document).first, 1e-6);
  }
}

TEST_F(OverlayMotion, IsDrivenByPointersAsWell) {
  const auto channel = [](const std::string& pointer) {
    return Document::Json::parse(
        R"({"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": ")" +
        pointer + "\"}}}}");
  };
  write_model([&](Document& document, const SmallMesh& plane) {
    add_hill(document, plane);
    document.json["extensionsUsed"] = {"KHR_animation_pointer"};
    document.json["animations"][0]["channels"] = {channel("/nodes/0/weights/0"), channel("/nodes/0/scale"),
                                                  channel("/nodes/01/weights")};
  });
  const Document document = bake();
  const auto& channels = document.json["animations"][0]["channels"];
  ASSERT_EQ(channels.size(), 4u);
  EXPECT_EQ(channels[3], channel("/nodes/" + std::to_string(overlays_of(document).at(0)) + "/weights/0"));
}

TEST_F(OverlayMotion, StaysAboveAMorphTarget) {
  write_model(add_hill);
  Document document = bake(0.01);
  const auto mesh = document.json["nodes"][overlays_of(document)[0]]["mesh"].get<std::size_t>();
  for (const std::size_t m : {std::size_t{0}, mesh}) document.json["meshes"][m]["weights"] = {1.0};
  const Model model = decode_model(document).value();
  for (const ModelPart& part : model.parts) {
    if (!is_overlay(document, part.node)) continue;
    for (const auto& t : part.triangles) {
      const Vec3 middle = (part.positions[t[0]] + part.positions[t[1]] + part.positions[t[2]]) / 3;
      const auto height = [](double x) { return 1 - x * x; };
      const double cell = 2.0 / cells, left = -1 + cell * std::floor((middle.x() + 1) / cell);
      const double share = (middle.x() - left) / cell;
      EXPECT_GT(middle.z(), (1 - share) * height(left) + share * height(left + cell));
    }
  }
}

TEST_F(OverlayMotion, FollowsASkinWithMorphTargets) {
  write_model([](Document& document, const SmallMesh& plane) {
    add_hill(document, plane);
    add_skin(document, plane);
  });
  Document document = bake();
  const auto overlays = overlays_of(document);
  ASSERT_EQ(overlays.size(), 1u);
  const auto mesh = document.json["nodes"][overlays[0]]["mesh"].get<std::size_t>();
  EXPECT_LT(distance_from_surface(document).first, 1e-6);
  for (const std::size_t m : {std::size_t{0}, mesh}) document.json["meshes"][m]["weights"] = {0.8};
  document.json["nodes"][2]["rotation"] = turn_about_y(60);
  EXPECT_LT(distance_from_surface(document).first, 1e-6);
}

/// Two halves on nodes of their own, one of which mirrors, under a parent.
TEST_F(OverlayMotion, IsDividedBetweenNodes) {
  SmallMesh left = make_plane("Left", cells, -1), right = make_plane("Right", cells, 1);
  for (Vec3& p : right.positions) p.x() = -p.x();
  for (auto& t : right.triangles) std::swap(t[1], t[2]);
  write_model([](Document&, const SmallMesh&) {});
  write_small_model(folder_ / "model.glb", {left, right}, {{"paint", std::nullopt, {1, 1, 1, 1}}});
  Document document = load_document(folder_ / "model.glb").value();
  document.json["nodes"][1]["scale"] = {-1, 1, 1};
  document.json["nodes"].push_back({{"name", "hinge"}, {"children", {1}}});
  document.json["scenes"][0]["nodes"] = {0, 2};
  ASSERT_TRUE(save_document(document, folder_ / "model.glb"));

  document = bake();
  ASSERT_EQ(overlays_of(document).size(), 2u);
  for (const std::size_t half : {0, 1}) EXPECT_EQ(document.json["nodes"][half]["children"].size(), 1u);
  EXPECT_EQ(document.json["meshes"][2]["primitives"][0]["material"],
            document.json["meshes"][3]["primitives"][0]["material"]);
  EXPECT_LT(distance_from_surface(document).first, 1e-6);
  const Model rest = decode_model(document).value();
  for (const ModelPart& part : rest.parts)
    for (const auto& t : part.triangles)
      EXPECT_GT((part.positions[t[1]] - part.positions[t[0]])
                    .cross(part.positions[t[2]] - part.positions[t[0]])
                    .z(),
                0)
          << "the outside is in front";
  document.json["nodes"][2]["rotation"] = turn_about_y(-50);
  EXPECT_LT(distance_from_surface(document).first, 1e-6);
}

/// A node that is flat at rest has no space to come back to.
TEST_F(OverlayMotion, StaysInTheSceneWhereANodeIsFlat) {
  write_model([](Document& document, const SmallMesh& plane) {
    add_hill(document, plane);
    document.json["nodes"][0]["scale"] = {1, 1, 0};
  });
  folder_.write("job.json", {{"version", 1},
                             {"model", "model.glb"},
                             {"decals",
                              {{{"name", "flag"},
                                {"image", "image.png"},
                                {"output", "overlay"},
                                {"size", 0.5},
                                {"up", {0, 1, 0}},
                                {"features", {{{"image", {128, 128}}, {"position", {0, 0, 0}}}}}}}}});
  const CommandResult result = folder_.run("bake job.json -o out.glb --report report.json");
  ASSERT_EQ(result.status, 0) << result.err;
  const json warnings = json::parse(folder_.read("report.json"))["decals"][0]["warnings"];
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0]["code"], "overlay_static");
  const Document document = load_document(folder_ / "out.glb").value();
  EXPECT_TRUE(document.json["scenes"][0]["nodes"].back() == overlays_of(document).at(0));
  EXPECT_LT(distance_from_surface(document).first, 0.01);
}

}  // namespace
