#include "overlay_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "overlay_layers.h"
#include "overlay_layout.h"
#include "solve_job.h"

using namespace applique;
using nlohmann::json;

namespace {

constexpr int image_size = 256;

/// The image on a plane of few, large triangles, bent strongly by features that no similarity fits; all by
/// the warp, since the conformal embedding of a plane is one.
class OverlayMeshTest : public testing::Test {
 protected:
  void SetUp() override {
    write_small_model(folder_ / "model.glb", {make_plane("Plane", 5)},
                      {{"paint", std::nullopt, {1, 1, 1, 1}}});
    write_png(folder_ / "image.png", make_noise(image_size));
    const auto pin = [](double x, double y, double px, double py) {
      return json({{"image", {x, y}}, {"position", {px, py, 0}}});
    };
    folder_.write(
        "job.json",
        {{"version", 1},
         {"model", "model.glb"},
         {"decals",
          json::array({{{"name", "bent"},
                        {"image", "image.png"},
                        {"opacity", 0.5},
                        {"energy", "conformal"},
                        {"features",
                         {pin(64, 64, -0.3, 0.25), pin(192, 64, 0.25, 0.2), pin(128, 128, 0.06, -0.03),
                          pin(64, 192, -0.25, -0.25), pin(192, 192, 0.25, -0.3)}}}})}});
    const auto job = load_job(folder_ / "job.json");
    ASSERT_TRUE(job) << job.error().message;
    auto solved = solve_job(*job);
    ASSERT_TRUE(solved) << solved.error().message;
    job_ = std::move(*solved);
  }

  const SolvedDecal& decal() const { return job_.decals.front(); }
  static Image draw(const OverlayLayout& layout, MaterialSlot slot, const Image& image) {
    const OverlayPicture shown = {slot, image};
    return draw_pictures(layout.chart, {&shown, 1}).front().image;
  }
  Image base_colour() {
    return make_overlay_layers(job_.model, job_.decals.front()).value().pictures.front().image;
  }

  CommandFolder folder_;
  SolvedJob job_;
};

/// Largest distance, in pixels, of the mesh's texture coordinates from the exact map, which is told
/// `influence(plane, sheet)`. The mesh's offset is 0.01.
template <class Influence>
double farthest_from_exact(const DecalMesh& mesh, const SolvedDecal& decal, const Influence& influence) {
  const DecalMap& map = decal.map;
  const ImageFrame& frame = decal.region.frame();
  // The embedding of a plane is a similarity: two points of a face give it.
  const PatchFace& face = map.patch.faces[PatchFaceId(0)];
  const auto corners = decal.surface->mesh.corners(face.mesh_face);
  const auto flat = [](const Vec3& p) { return Vec2(p.x(), p.y()); };
  const Vec2 turn =
      (map.plane[face.vertices[1]] - map.plane[face.vertices[0]]) / (flat(corners[1]) - flat(corners[0]));
  const auto exact = [&](const Vec3& p) {
    const Vec2 plane = map.plane[face.vertices[0]] + turn * (flat(p) - flat(corners[0]));
    return frame.to_pixel(map.warp(plane, influence(plane, std::lround(p.z() / 0.01) - 1)));
  };

  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  double farthest = 0;
  for (const auto& t : mesh.triangles)
    for (int sample = 0; sample < 40; ++sample) {
      const double root = std::sqrt(unit(random));
      const double split = unit(random);
      const std::array<double, 3> weights = {1 - root, root * (1 - split), root * split};
      Vec3 position = Vec3::Zero();
      Vec2 uv = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        position += weights[k] * mesh.positions[t[k]];
        uv += weights[k] * Vec2(mesh.uvs[t[k]][0], mesh.uvs[t[k]][1]);
      }
      const Pixel pixel = exact(position);
      farthest = std::max(farthest,
                          std::hypot(uv.real() * frame.width - pixel.x, uv.imag() * frame.height - pixel.y));
    }
  return farthest;
}

TEST_F(OverlayMeshTest, LinearTextureCoordinatesFollowTheExactMap) {
  const DecalMesh mesh = build_overlay_mesh(job_.model, decal(), 0.01);
  const auto none = [](Vec2, long) { return std::vector<double>(); };
  EXPECT_LT(farthest_from_exact(mesh, decal(), none), 0.25);
  // The test has teeth: without dividing, it is much more.
  const DecalMesh coarse = build_overlay_mesh(job_.model, decal(), 0, 1000);
  EXPECT_GT(mesh.triangles.size(), 4 * coarse.triangles.size());
}

TEST_F(OverlayMeshTest, SheetsLieOverOneAnotherFromTheBottomUp) {
  // The decal twice, the upper sheet first; the features are in two groups of opposite influence.
  const auto influence = [](Vec2 plane, long sheet) {
    const double share = 0.5 + (sheet == 0 ? 0.4 : -0.4) * plane.real();
    return std::vector<double>{share, 1 - share};
  };
  DecalMap& map = job_.decals.front().map;
  map.groups = map.warp.groups = 2;
  map.warp.group = {0, 0, 0, 1, 1};
  map.influence.clear();
  const std::size_t faces = map.patch.faces.size(), vertices = map.patch.vertices.size();
  for (const PatchFaceId f : ids<PatchFaceId>(faces)) {
    PatchFace face = map.patch.faces[f];
    for (PatchVertexId& v : face.vertices) v = PatchVertexId(v.value + vertices);
    map.patch.faces.push_back(face);
    map.textured.push_back(map.textured[f]);
    map.sheet[f] = 1;
    map.sheet.push_back(0);
  }
  for (const PatchVertexId v : ids<PatchVertexId>(vertices)) {
    map.patch.vertices.push_back(map.patch.vertices[v]);
    map.plane.push_back(map.plane[v]);
    map.image.push_back({});
  }
  for (const PatchVertexId v : ids<PatchVertexId>(2 * vertices)) {
    const auto at = influence(map.plane[v], v.value < vertices ? 1 : 0);
    map.influence.insert(map.influence.end(), at.begin(), at.end());
    map.image[v] = map.warp(map.plane[v], at);
  }

  const DecalMesh mesh = build_overlay_mesh(job_.model, decal(), 0.01);
  std::vector<double> heights;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) heights.push_back(mesh.positions[v].z());
  EXPECT_TRUE(std::is_sorted(heights.begin(), heights.end()));
  EXPECT_EQ(heights.front(), 0.01);
  EXPECT_EQ(heights.back(), 0.02);
  EXPECT_LT(farthest_from_exact(mesh, decal(), influence), 0.25);
  for (const Vec3& position : build_overlay_mesh(job_.model, decal(), 0).positions)
    EXPECT_EQ(position.z(), 0);
}

TEST_F(OverlayMeshTest, HasNoCracks) {
  // Nor where an upper sheet begins.
  job_.decals.front().map.sheet[PatchFaceId(0)] = 1;
  const DecalMesh mesh = build_overlay_mesh(job_.model, decal(), 0.01);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      ++edges[{a, b}];
    }
  const auto on_border = [&](std::uint32_t v) {
    const auto& uv = mesh.uvs[v];
    const auto at_end = [](double x) { return std::abs(x) < 1e-9 || std::abs(x - 1) < 1e-9; };
    return at_end(uv[0]) || at_end(uv[1]);
  };
  for (const auto& [edge, count] : edges) {
    if (count == 2) continue;
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(on_border(edge.first) && on_border(edge.second));
  }
}

TEST_F(OverlayMeshTest, LiesAboveTheSurfaceAndInsideTheImage) {
  const DecalMesh mesh = build_overlay_mesh(job_.model, decal(), 0.01);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].z(), 0.01, 1e-12);
    EXPECT_NEAR(mesh.normals[i].z(), 1, 1e-12);
    for (const double coordinate : mesh.uvs[i]) {
      EXPECT_GE(coordinate, -1e-9);
      EXPECT_LE(coordinate, 1 + 1e-9);
    }
  }
  for (const auto& t : mesh.triangles)
    EXPECT_GT(
        (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]).z(),
        0);
}

/// Red is x, green is y, in pixels.
Image make_ramp() {
  Image image = make_image(image_size, image_size, {0, 0, 0, 0xffff});
  for (int y = 0; y < image_size; ++y)
    for (int x = 0; x < image_size; ++x) {
      image.pixel(x, y)[0] = static_cast<std::uint16_t>(257 * x);
      image.pixel(x, y)[1] = static_cast<std::uint16_t>(257 * y);
    }
  return image;
}

TEST_F(OverlayMeshTest, OnASkinTrianglesStayWholeAndThePictureIsBent) {
  job_.model.document.json["nodes"][0]["skin"] = 0;
  job_.decals.front().image = make_ramp();
  const OverlayLayout layout = lay_out_overlay(job_.model, decal(), 0.01);
  const Image picture = draw(layout, MaterialSlot::base_color, base_colour());
  EXPECT_FALSE(layout.divided_skin);
  const DecalMap& map = decal().map;
  EXPECT_EQ(layout.mesh.triangles.size(), std::count(map.textured.begin(), map.textured.end(), char(1)));
  // What a triangle shows at a place is what the exact map puts there.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int compared = 0;
  for (std::size_t t = 0; t < layout.mesh.triangles.size(); ++t)
    for (int sample = 0; sample < 40; ++sample) {
      const double root = std::sqrt(unit(random)), split = unit(random);
      const std::array<double, 3> weights = {1 - root, root * (1 - split), root * split};
      Vec2 plane = 0, uv = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = layout.mesh.triangles[t][k];
        plane += weights[k] * map.plane[layout.mesh.origins[v].vertices[0]];
        uv += weights[k] * Vec2(layout.mesh.uvs[v][0], layout.mesh.uvs[v][1]);
      }
      const Pixel exact = decal().region.frame().to_pixel(map.warp(plane));
      if (std::min(exact.x, exact.y) < 2 || std::max(exact.x, exact.y) > image_size - 2) continue;
      const std::uint16_t* texel =
          picture.pixel(int(uv.real() * picture.width), int(uv.imag() * picture.height));
      EXPECT_NEAR(texel[0] / 257.0, exact.x - 0.5, 1);
      EXPECT_NEAR(texel[1] / 257.0, exact.y - 0.5, 1);
      EXPECT_EQ(texel[3], 0x8000) << "the decal's opacity";
      ++compared;
    }
  EXPECT_GT(compared, 500);
  EXPECT_EQ(picture.pixel(0, 0)[3], 0) << "nothing around it";
}

TEST_F(OverlayMeshTest, NormalsTurnWhereThePictureIsBent) {
  job_.model.document.json["nodes"][0]["skin"] = 0;
  const OverlayLayout layout = lay_out_overlay(job_.model, decal(), 0.01);
  const Vec3 relief = Vec3(0.6, 0.3, 0.8).normalized();
  std::array<std::uint16_t, 4> stored = {0, 0, 0, 65535};
  for (int c = 0; c < 3; ++c)
    stored[c] = static_cast<std::uint16_t>(std::lround(65535 * (0.5 + 0.5 * relief[c])));
  const Image picture = draw(layout, MaterialSlot::normal, make_image(image_size, image_size, stored));
  // Where a step along the image's x comes from is the direction of that x in the picture.
  const ImageFrame& frame = decal().region.frame();
  const auto place_of = [&](Pixel pixel) {
    return frame.to_pixel(decal().map.warp.backward(frame.to_plane(pixel)));
  };
  double least = 10, most = -10;
  for (double y = 20; y < image_size; y += 31)
    for (double x = 20; x < image_size; x += 31) {
      const Pixel from = place_of({x, y}), to = place_of({x + 0.5, y});
      const Vec2 along = Vec2(to.x - from.x, from.y - to.y) / std::hypot(to.x - from.x, from.y - to.y);
      const Vec2 shown = Vec2(relief.x(), relief.y()) * along;
      const Eigen::Vector2d texel =
          layout.chart.density * (Eigen::Vector2d(from.x, from.y) - layout.chart.origin);
      const std::uint16_t* normal = picture.pixel(int(texel.x()), int(texel.y()));
      EXPECT_NEAR(normal[0] / 65535.0, 0.5 + 0.5 * shown.real(), 0.01);
      EXPECT_NEAR(normal[1] / 65535.0, 0.5 + 0.5 * shown.imag(), 0.01);
      EXPECT_NEAR(normal[2] / 65535.0, 0.5 + 0.5 * relief.z(), 1e-4);
      least = std::min(least, std::arg(along));
      most = std::max(most, std::arg(along));
    }
  EXPECT_GT(most - least, 0.2) << "it is bent";
}

TEST_F(OverlayMeshTest, OnASkinAnImageThatLiesOverItselfIsDivided) {
  job_.model.document.json["nodes"][0]["skin"] = 0;
  DecalMap& map = job_.decals.front().map;
  map.groups = map.warp.groups = 2;
  map.warp.group = {0, 0, 0, 1, 1};
  map.influence.assign(2 * map.patch.vertices.size(), 0.5);
  const OverlayLayout layout = lay_out_overlay(job_.model, decal(), 0.01);
  EXPECT_TRUE(layout.divided_skin);
  EXPECT_EQ(layout.chart.width, image_size);
}

TEST_F(OverlayMeshTest, PictureCarriesTheOpacity) {
  const Image image = base_colour();
  EXPECT_EQ(image.channels, 4);
  EXPECT_EQ(image.pixel(128, 128)[3], 0x8000);
  EXPECT_EQ(image.pixel(128, 128)[0], decal().image.pixel(128, 128)[0]);
}

}  // namespace
