#include "uv_resample.h"

#include <cmath>

#include <gtest/gtest.h>

#include "applique/image/decal_image.h"

#include "cli/small_model.h"

namespace applique {
namespace {

/// A square of 16 units at (8, 8) in an atlas of 32 x 32, of two triangles.
UvLayout make_layout(bool kept) {
  UvLayout layout;
  layout.corners = {{Texel{8, 8}, {8, 24}, {24, 24}}, {Texel{8, 8}, {24, 24}, {24, 8}}};
  layout.charts = {{{0, 1}, kept, {-24, 40}, {4, 4, 24, 24}}};
  layout.size = {32, 32};
  layout.gutter = 4;
  return layout;
}

/// Turned by a quarter: the atlas's x runs along the old y.
Resampling make_turned(const UvLayout& layout, const Image& texture) {
  Resampling resampling;
  resampling.texture = &texture;
  resampling.layout = &layout;
  resampling.size = {32, 32};
  resampling.old_corners = {{Texel{0, 0}, {16, 0}, {16, 16}}, {Texel{0, 0}, {16, 16}, {0, 16}}};
  return resampling;
}

TEST(ResampleTexture, CopiesAKeptChartWithItsGutterToTheBit) {
  const Image texture = make_noise(16);
  const UvLayout layout = make_layout(true);
  Resampling resampling;
  resampling.texture = &texture;
  resampling.layout = &layout;
  resampling.reference = {1, 1};
  for (const int fineness : {1, 3}) {
    UvLayout finer = layout;
    finer.fineness = fineness;
    finer.size = {32 * fineness, 32 * fineness};
    resampling.layout = &finer;
    resampling.size = finer.size;
    const Image atlas = resample_texture(resampling);
    // The box from 4 to 28: old texel = unit + shift, repeated every 16. Every texel's centre stays one.
    for (int y = 4; y < 28; ++y)
      for (int x = 4; x < 28; ++x)
        for (int c = 0; c < 4; ++c)
          ASSERT_EQ(atlas.pixel(fineness * x + fineness / 2, fineness * y + fineness / 2)[c],
                    texture.pixel((x - 24 + 32) % 16, (y + 40) % 16)[c]);
  }
}

TEST(ResampleTexture, TurnsAChartToTheBit) {
  const Image texture = make_noise(16);
  const UvLayout layout = make_layout(false);
  const Image atlas = resample_texture(make_turned(layout, texture));
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(atlas.pixel(8 + x, 8 + y)[c], texture.pixel(y, x)[c]) << x << ", " << y;
  // The gutter goes on as the texture does, from its first row to its last.
  for (int x = 4; x < 8; ++x)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(atlas.pixel(x, 16)[c], texture.pixel(8, x + 8)[c]) << x;
}

TEST(ResampleTexture, MeansInLinearLight) {
  // Black and white columns, seen at half the size.
  Image texture = make_image(16, 16, {0, 0, 0, 0xffff});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; x += 2)
      for (int c = 0; c < 3; ++c) texture.pixel(x, y)[c] = 0xffff;
  const UvLayout layout = make_layout(false);
  for (const TexelContent content : {TexelContent::colour, TexelContent::data}) {
    Resampling resampling = make_turned(layout, texture);
    resampling.size = {16, 16};
    resampling.content = content;
    const Image atlas = resample_texture(resampling);
    const int expected = content == TexelContent::colour ? 188 : 128;
    EXPECT_NEAR(atlas.pixel(8, 8)[0] / 257.0, expected, 1);
  }
}

TEST(ResampleTexture, TurnsNormals) {
  const auto stored = [](double x) {
    return static_cast<std::uint16_t>(257 * std::lround(127.5 + 127.5 * x));
  };
  const Image texture = make_image(16, 16, {stored(0.6), stored(0), stored(0.8), 0xffff});
  const UvLayout layout = make_layout(false);
  Resampling resampling = make_turned(layout, texture);
  resampling.content = TexelContent::normal;
  resampling.turns.assign(2, {FrameTurn{0, 1, -1, 0}, FrameTurn{0, 1, -1, 0}, FrameTurn{0, 1, -1, 0}});
  const Image atlas = resample_texture(resampling);
  EXPECT_NEAR(atlas.pixel(16, 12)[0], stored(0), 257);
  EXPECT_NEAR(atlas.pixel(16, 12)[1], stored(-0.6), 257);
  EXPECT_EQ(atlas.pixel(16, 12)[2], stored(0.8));
}

}  // namespace
}  // namespace applique
