#include "applique/gpu/renderer.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "applique/image/decal_image.h"

#include "gpu/gpu_fixture.h"

namespace applique {
namespace {

using RendererTest = GpuTest;
constexpr std::uint16_t full = 65535;

// A square of side 2 around the origin at height z, seen from +z, with the whole texture on it.
RenderMesh square(const Image* texture, float z = 0) {
  RenderMesh mesh;
  mesh.positions = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.base_colour = texture;
  return mesh;
}

RenderMesh coloured_square(std::array<float, 4> colour, float z) {
  RenderMesh mesh = square(nullptr, z);
  mesh.base_colour_factor = colour;
  return mesh;
}

// Which of the channels of a pixel is clearly the largest; -1 for none.
int strongest(const Image& image, int x, int y) {
  const std::uint16_t* p = image.pixel(x, y);
  for (int c = 0; c < 3; ++c) {
    if (p[c] > 1.5 * p[(c + 1) % 3] && p[c] > 1.5 * p[(c + 2) % 3]) return c;
  }
  return -1;
}

Camera front(double zoom = 1) {
  return orbit({0, 0, 0}, 1.2, 0, 0, zoom);
}
constexpr RenderOptions small = {200, 200};

TEST_F(RendererTest, PutsTheTextureTheRightWayUp) {
  Image texture = make_image(64, 64, {full, full, full, full});
  const std::array<std::array<std::uint16_t, 4>, 3> colours = {
      {{full, 0, 0, full}, {0, full, 0, full}, {0, 0, full, full}}};
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const int quadrant = x / 32 + 2 * (y / 32);  // Red, green / blue, white.
      if (quadrant < 3) std::copy(colours[quadrant].begin(), colours[quadrant].end(), texture.pixel(x, y));
    }
  }
  const std::vector<RenderMesh> meshes = {square(&texture)};
  const Image picture = render(device(), meshes, front(), small).value();
  ASSERT_EQ(picture.width, 200);
  EXPECT_EQ(strongest(picture, 60, 60), 0);
  EXPECT_EQ(strongest(picture, 140, 60), 1);
  EXPECT_EQ(strongest(picture, 60, 140), 2);
  EXPECT_EQ(strongest(picture, 140, 140), -1);
}

/// Waves, whose period is the twentieth of a side.
Image waves(int size) {
  Image image = make_image(size, size, {0, 0, 0, full});
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double wave = std::sin(40 * 3.14159265 * (x + 0.7 * y + 0.85) / size);
      std::fill_n(image.pixel(x, y), 3, static_cast<std::uint16_t>(std::lround(full * (0.5 + 0.4 * wave))));
    }
  return image;
}

TEST_F(RendererTest, InterpolatesTexturesOfAnySize) {
  const Image fine = waves(1024), odd = waves(211);
  for (const float shift : {0.0F, 3.0F}) {
    std::array<Image, 2> pictures;
    for (int i = 0; i < 2; ++i) {
      std::vector<RenderMesh> meshes = {square(i == 0 ? &fine : &odd)};
      for (auto& uv : meshes[0].uvs) uv[0] += shift;
      pictures[i] = render(device(), meshes, front(), {600, 600}).value();
    }
    int largest = 0;
    for (std::size_t i = 0; i < pictures[0].rgba.size(); ++i)
      largest = std::max(largest, std::abs(int{pictures[0].rgba[i]} - int{pictures[1].rgba[i]}));
    // What bilinear interpolation loses of a wave of 10 texels, and a little more: 12 of 255.
    EXPECT_LT(largest / 257.0, 16) << shift;
  }
}

/// Filters that go over all texels under a pixel would not come to an end.
TEST_F(RendererTest, ShowsTheMeanOfWhatRepeatsTooOften) {
  const Image fine = waves(512);
  for (const float often : {1e3F, 1e6F, 1e9F, 1e20F}) {
    std::vector<RenderMesh> meshes = {square(&fine)};
    for (auto& uv : meshes[0].uvs) uv = {often * uv[0], 0.3F * often * uv[1] + often * uv[0]};
    const Image repeated = render(device(), meshes, front(), small).value();
    double light = 0;
    for (int x = 0; x < fine.width; ++x)
      light += srgb_to_linear(fine.pixel(x, 0)[0] / double{full}) / fine.width;
    const auto grey = static_cast<std::uint16_t>(std::lround(full * linear_to_srgb(light)));
    const Image mean = make_image(1, 1, {grey, grey, grey, full});
    meshes[0].base_colour = &mean;
    const Image expected = render(device(), meshes, front(), small).value();
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(repeated.pixel(100, 100)[c] / 257.0, expected.pixel(100, 100)[c] / 257.0, 8) << often;
  }
}

TEST_F(RendererTest, HidesWhatIsBehind) {
  for (const bool near_first : {false, true}) {
    std::vector<RenderMesh> meshes = {coloured_square({1, 0, 0, 1}, -0.1F),
                                      coloured_square({0, 1, 0, 1}, 0.1F)};
    if (near_first) std::swap(meshes[0], meshes[1]);
    EXPECT_EQ(strongest(render(device(), meshes, front(), small).value(), 100, 100), 1);
  }
}

TEST_F(RendererTest, ShowsBackFacesOnlyOfDoubleSidedMeshes) {
  const Camera behind = orbit({0, 0, 0}, 1.2, 180, 0);
  std::vector<RenderMesh> meshes = {coloured_square({1, 0, 0, 1}, 0)};
  EXPECT_EQ(strongest(render(device(), meshes, behind, small).value(), 100, 100), -1);
  meshes[0].double_sided = true;
  const Image back = render(device(), meshes, behind, small).value();
  EXPECT_EQ(strongest(back, 100, 100), 0);
  // Lit as a front face is, with its normal turned over.
  const Image face = render(device(), meshes, front(), small).value();
  EXPECT_NEAR(back.pixel(100, 100)[0], face.pixel(100, 100)[0], 600);
}

TEST_F(RendererTest, LightsWithoutNormalsAsWithTheFacesOwn) {
  RenderMesh mesh = square(nullptr);
  mesh.double_sided = true;
  mesh.base_colour_factor = {0.4F, 0.4F, 0.4F, 1};
  RenderMesh flat = mesh;
  flat.normals.clear();
  for (const double azimuth : {40.0, 140.0}) {
    const Camera camera = orbit({0, 0, 0}, 1.2, azimuth, 30, 1);
    const Image expected = render(device(), std::vector{mesh}, camera, small).value();
    const Image picture = render(device(), std::vector{flat}, camera, small).value();
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(picture.pixel(100, 100)[c], expected.pixel(100, 100)[c], 257) << azimuth;
  }
}

TEST_F(RendererTest, BlendsAfterOpaqueAndCutsMasks) {
  // Given in the wrong order: the blended square is drawn last all the same.
  std::vector<RenderMesh> meshes = {coloured_square({0, 1, 0, 0.5F}, 0.1F), coloured_square({1, 0, 0, 1}, 0)};
  meshes[0].alpha_mode = AlphaMode::blend;
  const Image blended = render(device(), meshes, front(), small).value();
  EXPECT_GT(blended.pixel(100, 100)[0], 20000);
  EXPECT_GT(blended.pixel(100, 100)[1], 20000);
  meshes[0].alpha_mode = AlphaMode::mask;
  meshes[0].alpha_cutoff = 0.6F;
  EXPECT_EQ(strongest(render(device(), meshes, front(), small).value(), 100, 100), 0);
  meshes[0].alpha_cutoff = 0.4F;
  EXPECT_EQ(strongest(render(device(), meshes, front(), small).value(), 100, 100), 1);
}

TEST_F(RendererTest, FramesPoints) {
  const std::vector<Vec3> points = {{2, 3, 4}, {3, 3, 4}, {2, 5, 4}, {2.5, 4, 5}};
  for (const double aspect : {0.5, 1.0, 2.0}) {
    const Camera camera = frame_points(points, {1, 0.3, 2}, {0, 1, 0}, aspect, 0.1);
    const Eigen::Matrix4d matrix = view_projection(camera, aspect, 0.1, 100);
    double extent = 0;
    for (const Vec3& point : points) {
      const Eigen::Vector4d clip = matrix * point.homogeneous();
      extent = std::max({extent, std::abs(clip.x() / clip.w()), std::abs(clip.y() / clip.w())});
    }
    EXPECT_NEAR(extent, 0.8, 1e-9) << aspect;
  }
}

TEST_F(RendererTest, DrawsTheBackdropForNoMeshes) {
  const Image picture = render(device(), {}, front(), small).value();
  EXPECT_GT(picture.pixel(100, 5)[1], picture.pixel(100, 195)[1]);
}

TEST_F(RendererTest, RefusesAPictureThatIsTooLarge) {
  const auto result = render(device(), {}, front(), {1 << 20, 16});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::device_failed);
}

}  // namespace
}  // namespace applique
