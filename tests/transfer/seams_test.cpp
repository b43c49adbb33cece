#include "applique/transfer/seams.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace applique {
namespace {

constexpr int side = 64, edges = 8;

/// A polyline along which two islands of one texture meet, at directions and scales of their own; of several,
/// the first sides lie in rows.
std::vector<Seam> random_seams(std::mt19937& random, int row = 0) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double angle = 2 * M_PI * unit(random), scale = 0.1 + 0.9 * unit(random);
  std::vector<Texel> here, there;
  for (int i = 0; i <= edges; ++i) {
    here.push_back({4 + 3.0 * i, 10 + 4 * row + 3 * unit(random)});
    const double way = 2.5 * scale * (i - edges / 2.0);
    there.push_back({44 + way * std::cos(angle), 42 + way * std::sin(angle)});
  }
  std::vector<Seam> seams;
  for (int i = 0; i < edges; ++i) {
    Seam& seam = seams.emplace_back();
    seam.sides[0] = {0, {here[i], here[i + 1]}, {here[i][0], here[i][1] + 3}};
    seam.sides[1] = {
        0, {there[i], there[i + 1]}, {there[i][0] - 3 * std::sin(angle), there[i][1] + 3 * std::cos(angle)}};
  }
  return seams;
}

/// Of 255: the most that both sides differ by.
double largest_difference(std::span<const Seam> seams, std::span<const SeamTexture> textures,
                          Encoding encoding) {
  double largest = 0;
  int compared = 0;
  for (const SeamSample& sample : sample_seams(seams, textures, encoding)) {
    if (!sample.changed) continue;
    ++compared;
    for (std::size_t c = 0; c < 4; ++c)
      largest = std::max(largest, 255 * std::abs(sample.colours[0][c] - sample.colours[1][c]));
  }
  EXPECT_GT(compared, 20);
  return largest;
}

/// Noise is the worst that can be asked for: neighbours know nothing of one another.
TEST(Seams, ExactOnesAgreeOnNoise) {
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    Image image = make_image(side, side, {0, 0, 0, 0});
    Image before = image;
    for (std::size_t i = 0; i < image.rgba.size(); ++i) {
      image.rgba[i] = static_cast<std::uint16_t>(257 * (random() % 256));
      before.rgba[i] = image.rgba[i] ^ 0x101;  // All are changed.
    }
    const std::vector<Seam> seams = random_seams(random);
    const std::vector<SeamTexture> textures = {
        {&image, &before, WrapMode::repeat, WrapMode::repeat, {true, true, true, true}}};
    for (const Encoding encoding : {Encoding::colour, Encoding::data}) {
      EXPECT_GT(largest_difference(seams, textures, encoding), 20);
      const Image noise = image;
      join_seams(seams, textures, encoding, SeamFit::exact);
      EXPECT_LT(largest_difference(seams, textures, encoding), 2) << round;
      image = noise;
    }
  }
}

/// Seams that cross and crowd, between texels that are black or white, none of which can go beyond, round
/// holes of the decal, where texels stay.
TEST(Seams, ExactOnesAgreeBetweenBlackAndWhite) {
  constexpr int rows = 12;
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    Image image = make_image(side, side, {0x8000, 0x8000, 0x8000, 0x8000});
    const Image before = image;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (std::hypot(x % 16 - 8, y % 16 - 8) > 3)
          std::generate_n(image.pixel(x, y), 4, [&] { return random() % 2 == 0 ? 0 : 0xffff; });
    std::vector<Seam> seams;
    for (int row = 0; row < rows; ++row)
      for (const Seam& seam : random_seams(random, row)) seams.push_back(seam);
    const std::vector<SeamTexture> textures = {
        {&image, &before, WrapMode::repeat, WrapMode::repeat, {true, true, true, true}}};
    join_seams(seams, textures, Encoding::colour, SeamFit::exact);
    EXPECT_LT(largest_difference(seams, textures, Encoding::colour), 2) << round;
  }
}

/// White is as far as values go, and so is an opaque alpha: where the sides agree, nothing moves.
TEST(Seams, WhatAgreesStays) {
  std::mt19937 random(6);
  for (const int bits : {8, 16})
    for (const SeamFit fit : {SeamFit::sharp, SeamFit::exact})
      for (const std::uint16_t value : std::initializer_list<std::uint16_t>{0, 0x3333, 0xffff}) {
        Image image = make_image(side, side, {value, value, value, 0xffff});
        image.bits = bits;
        const Image now = image;
        const Image before = make_image(side, side, {0x8000, 0x8000, 0x8000, 0});
        const std::vector<Seam> seams = random_seams(random);
        const std::vector<SeamTexture> textures = {
            {&image, &before, WrapMode::repeat, WrapMode::repeat, {true, true, true, true}}};
        join_seams(seams, textures, Encoding::colour, fit);
        EXPECT_EQ(image.rgba, now.rgba);
        // Beside colours that do not agree, the alpha stays opaque.
        for (std::size_t i = 0; i < image.rgba.size(); ++i)
          if (i % 4 != 3) image.rgba[i] = static_cast<std::uint16_t>(257 * (random() % 256));
        join_seams(seams, textures, Encoding::colour, fit);
        for (std::size_t i = 3; i < image.rgba.size(); i += 4) ASSERT_EQ(image.rgba[i], 0xffff);
      }
}

/// An alpha that differs elsewhere: values at their bound that no seam draws stay at it.
TEST(Seams, ValuesAtABoundStayThereUnlessDrawn) {
  std::mt19937 random(7);
  for (const int bits : {8, 16}) {
    Image image = make_image(side, side, {0xffff, 0xffff, 0xffff, 0xffff});
    image.bits = bits;
    const Image before = make_image(side, side, {0x8000, 0x8000, 0x8000, 0});
    const std::vector<Seam> near = random_seams(random), far = random_seams(random, 10);
    // Only one seam has sides that differ.
    for (int y = 50; y < side; ++y)
      for (int x = 0; x < 28; ++x)
        for (int c = 0; c < 4; ++c) image.pixel(x, y)[c] = static_cast<std::uint16_t>(257 * (random() % 256));
    std::vector<Seam> seams = near;
    for (Seam seam : far) {
      for (Texel& end : seam.sides[1].ends) end[1] = 55, end[0] = 4 + 0.4 * end[0];
      seam.sides[1].apex = {seam.sides[1].ends[0][0], 60};
      seams.push_back(seam);
    }
    const Image now = image;
    const std::vector<SeamTexture> textures = {
        {&image, &before, WrapMode::repeat, WrapMode::repeat, {true, true, true, true}}};
    join_seams(seams, textures, Encoding::colour, SeamFit::exact);
    EXPECT_NE(image.rgba, now.rgba);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x)
        for (int c = 0; c < 4; ++c) ASSERT_EQ(image.pixel(x, y)[c], 0xffff) << x << " " << y;
  }
}

/// Normals in frames that are turned and mirrored against one another.
TEST(Seams, ExactOnesAgreeOnNormals) {
  std::mt19937 random(5);
  const auto axis = [&] { return std::polar(1.0, 2 * M_PI * static_cast<double>(random() % 1000) / 1000); };
  for (int round = 0; round < 10; ++round) {
    Image image = make_image(side, side, {0x8000, 0x8000, 0xffff, 0xffff});
    const Image before = image;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      for (std::size_t c = 0; c < 3; ++c)
        image.rgba[i + c] =
            static_cast<std::uint16_t>(c < 2 ? 0x4000 + random() % 0x8000 : 0xc000 + random() % 0x4000);
    std::vector<Seam> seams = random_seams(random);
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec2 turn = axis(), across = random() % 2 == 0 ? Vec2(0, 1) : Vec2(0, -1);
      for (Seam& seam : seams) seam.sides[k].axes = {{{turn, turn * across}, {turn, turn * across}}};
    }
    const std::vector<SeamTexture> textures = {
        {&image, &before, WrapMode::repeat, WrapMode::repeat, {true, true, true, false}}};
    EXPECT_GT(largest_difference(seams, textures, Encoding::normal), 20);
    join_seams(seams, textures, Encoding::normal, SeamFit::exact);
    EXPECT_LT(largest_difference(seams, textures, Encoding::normal), 2) << round;
    EXPECT_EQ(image.rgba[3], 0xffff);
  }
}

/// What the decals did not change is not theirs to move.
TEST(Seams, OnlyChangedTexelsMove) {
  std::mt19937 random(2);
  Image image = make_image(side, side, {0, 0, 0, 0});
  for (std::uint16_t& value : image.rgba) value = static_cast<std::uint16_t>(257 * (random() % 256));
  Image before = image;
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i / 4 % 2 == 0) before.rgba[i] ^= 0x101;
  const Image now = image;
  const std::vector<Seam> seams = random_seams(random);
  const std::vector<SeamTexture> textures = {
      {&image, &before, WrapMode::repeat, WrapMode::repeat, {true, true, true, false}}};
  join_seams(seams, textures, Encoding::colour, SeamFit::exact);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i / 4 % 2 == 1 || i % 4 == 3) {
      ASSERT_EQ(image.rgba[i], now.rgba[i]) << i;
    }
}

}  // namespace
}  // namespace applique
