// Overlays over hard edges: shaded as the surface under them, and closed all the same.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "binary_edit.h"
#include "cli/sheet.h"

namespace applique {
namespace {

using nlohmann::json;

using Place = std::array<double, 3>;
Place place_of(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

/// A decal around the upright edge of a box, between its sides +x and +z.
class OverlayEdges : public SheetTest {
 protected:
  static constexpr int size = 128;

  void SetUp() override {
    Image image = make_image(size, size, {0xc000, 0x9000, 0x6000, 0xffff});
    image.channels = 3;
    write_png(folder_ / "image.png", image);
  }

  /// [-1, 1] cubed, each side a grid of its own.
  void write_box(bool normals, int cells) {
    SmallMesh box;
    box.name = "Box";
    for (int side = 0; side < 6; ++side) {
      const double sign = side % 2 == 0 ? 1 : -1;
      const Vec3 out = sign * Vec3::Unit(side / 2), along = Vec3::Unit((side / 2 + 1) % 3);
      const Vec3 across = out.cross(along);
      const auto first = static_cast<std::uint32_t>(box.positions.size());
      const auto index = [&](int i, int j) {
        return first + static_cast<std::uint32_t>(j * (cells + 1) + i);
      };
      for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
          const double u = double(i) / cells, v = double(j) / cells;
          box.positions.emplace_back(out + (2 * u - 1) * along + (2 * v - 1) * across);
          if (normals) box.normals.push_back(out);
          box.uvs.push_back({(side % 3 + 0.05 + 0.9 * u) / 3, (side / 3 + 0.05 + 0.9 * v) / 2});
          if (i == cells || j == cells) continue;
          box.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
          box.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    }
    write_small_model(folder_ / "model.glb", {box}, {{"paint", std::nullopt, {0.8, 0.8, 0.8, 1}}});
  }

  static json edge_job(const char* output) {
    const auto pin = [](double x, double y, const Vec3& p) {
      return json(
          {{"image", {x * size, y * size}}, {"position", {p.x(), p.y(), p.z()}}, {"max_distance", 1}});
    };
    return {{"version", 1},
            {"model", "model.glb"},
            {"texture_size", 1024},
            {"decals",
             {{{"name", "crest"},
               {"image", "image.png"},
               {"output", output},
               {"features",
                {pin(0.25, 0.25, {0.6, 0.4, 1}), pin(0.75, 0.25, {1, 0.4, 0.6}),
                 pin(0.5, 0.75, {1, -0.4, 1})}}}}}};
  }

  /// Every corner of the overlay has the normal of the side of the box under its triangle, +x's and +z's
  /// being these; at the edge there are both normals at every place.
  static void expect_normals(const ModelPart& overlay, const Vec3& at_x, const Vec3& at_z) {
    std::array<int, 2> triangles = {0, 0};
    std::map<Place, std::set<bool>> at_place;
    for (const auto& t : overlay.triangles) {
      Vec3 centre = Vec3::Zero();
      for (const std::uint32_t v : t) centre += overlay.positions[v] / 3;
      const bool on_x = centre.x() > centre.z();
      ++triangles[on_x ? 0 : 1];
      for (const std::uint32_t v : t) {
        EXPECT_LT((overlay.normals[v] - (on_x ? at_x : at_z)).norm(), 1e-6);
        at_place[place_of(overlay.positions[v])].insert(on_x);
      }
    }
    EXPECT_GT(triangles[0], 5);
    EXPECT_GT(triangles[1], 5);
    int doubled = 0;
    for (const auto& [place, sides] : at_place) {
      const bool on_edge = std::abs(place[0] - place[2]) < 1e-6;
      EXPECT_EQ(sides.size(), on_edge ? 2u : 1u) << place[0] << ' ' << place[1] << ' ' << place[2];
      if (on_edge) ++doubled;
    }
    EXPECT_GT(doubled, 2);
  }

  void bake_overlay() {
    const CommandResult result = bake(edge_job("overlay"));
    ASSERT_EQ(result.status, 0) << result.err;
  }
};

TEST_F(OverlayEdges, NormalsAreThoseOfTheSurface) {
  for (const bool normals : {true, false}) {
    SCOPED_TRACE(normals ? "split vertices" : "a file without normals is flat");
    write_box(normals, 3);
    bake_overlay();
    expect_normals(part_named(output(), "crest"), Vec3::UnitX(), Vec3::UnitZ());
  }
}

TEST_F(OverlayEdges, NormalsAreThoseOfTheSurfaceBelowANodeThatShears) {
  write_box(true, 3);
  edit_model([](Document& document) {  // Along the edge's y.
    document.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0.2, 1, 0.2, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  });
  bake_overlay();
  expect_normals(part_named(output(), "crest"), Vec3(1, -0.2, 0).normalized(), Vec3(0, -0.2, 1).normalized());
}

TEST_F(OverlayEdges, NormalsAreThoseOfTheSurfaceAsMorphTargetsTurnThem) {
  write_box(true, 3);
  edit_model([](Document& document) {
    auto& primitive = document.json["meshes"][0]["primitives"][0];
    auto& accessors = document.json["accessors"];
    const auto count =
        accessors[primitive["attributes"]["POSITION"].get<std::size_t>()]["count"].get<std::size_t>();
    const auto add = [&](const std::array<float, 3>& move) {
      std::vector<std::array<float, 3>> moves(count, move);
      const std::size_t view =
          add_buffer_view(document, {reinterpret_cast<const std::uint8_t*>(moves.data()), 12 * count});
      accessors.push_back(
          {{"bufferView", view}, {"componentType", 5126}, {"count", count}, {"type", "VEC3"}});
      accessors.back()["min"] = accessors.back()["max"] = move;
      return accessors.size() - 1;
    };
    const std::size_t positions = add({0, 0, 0}), normals = add({0, 0.8F, 0});
    primitive["targets"] = {{{"POSITION", positions}, {"NORMAL", normals}}};
    document.json["meshes"][0]["weights"] = {0.5};
  });
  bake_overlay();
  expect_normals(part_named(output(), "crest"), Vec3(1, 0.4, 0).normalized(), Vec3(0, 0.4, 1).normalized());
  // And at the target's other end.
  Document other = load_document(folder_ / "out.glb").value();
  for (auto& mesh : other.json["meshes"]) mesh["weights"] = {0};
  expect_normals(part_named(decode_model(std::move(other)).value(), "crest"), Vec3::UnitX(), Vec3::UnitZ());
}

TEST_F(OverlayEdges, LooksAsBaked) {
  for (const bool normals : {true, false}) {
    SCOPED_TRACE(normals ? "split vertices" : "flat");
    write_box(normals, 3);
    std::vector<Image> pictures;
    for (const char* output : {"bake", "overlay"}) {
      const CommandResult result = bake(edge_job(output), "-o out.glb --preview preview.png");
      ASSERT_EQ(result.status, 0) << result.err;
      pictures.push_back(read_image(folder_ / "preview.png").value());
    }
    // Within the decal, but for the pixels beside its border and the edge.
    const auto &baked = pictures[0], &overlaid = pictures[1];
    double largest = 0;
    std::set<int> shades;
    for (int y = baked.height / 4; y < 3 * baked.height / 4; ++y)
      for (int x = baked.width / 3; x < 2 * baked.width / 3; ++x) {
        if (std::abs(x - baked.width / 2) < 20) continue;
        shades.insert(baked.pixel(x, y)[0] >> 8);
        for (int c = 0; c < 3; ++c)
          largest = std::max(largest, std::abs(double(baked.pixel(x, y)[c]) - overlaid.pixel(x, y)[c]) / 257);
      }
    RecordProperty("largest", std::to_string(largest));
    EXPECT_LT(largest, 2);
    EXPECT_GT(*shades.rbegin() - *shades.begin(), 20) << "the sides are lit differently";
  }
}

}  // namespace
}  // namespace applique
