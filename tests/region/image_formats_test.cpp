// Formats other than PNG: what is decoded is what was written, as straight sRGB at 8 or 16 bits.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "applique/image/image.h"

namespace applique {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Writes values by OpenImageIO, as another program would.
template <class Value>
Bytes write_with_oiio(const char* format, OIIO::ImageSpec spec, const std::vector<Value>& values) {
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto output = OIIO::ImageOutput::create(format);
  EXPECT_TRUE(output && output->open(std::string("test.") + format, spec) &&
              output->write_image(OIIO::BaseTypeFromC<Value>::value, values.data()) && output->close())
      << OIIO::geterror();
  return bytes;
}

/// What sRGB makes of linear light, at 16 bits; written out here, not the engine's own.
std::uint16_t encoded(double linear) {
  const double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<std::uint16_t>(std::lround(65535 * value));
}

void expect_near(const std::uint16_t* pixel, std::array<std::uint16_t, 4> expected, int tolerance) {
  for (int k = 0; k < 4; ++k)
    EXPECT_LE(std::abs(int(pixel[k]) - int(expected[static_cast<std::size_t>(k)])), tolerance)
        << "channel " << k << ": " << pixel[k] << ", expected " << expected[static_cast<std::size_t>(k)];
}

constexpr int half_step = 40;  // of 65535: what 16-bit floats lose

TEST(FloatImage, ExrIsLinearPremultipliedAndClamped) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  const std::vector<float> values = {0.5F,   0.25F, 0.125F, 1, 0.25F,    0.125F, 0.0625F, 0.5F, 4, -1,
                                     0.002F, 1,     nan,    1, infinite, 1,      0,       0,    0, 0};
  for (const auto type : {OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT}) {
    const auto image = decode_image(write_with_oiio("exr", OIIO::ImageSpec(5, 1, 4, type), values), "a.exr");
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->bits, 16);
    EXPECT_EQ(image->channels, 4);
    expect_near(image->pixel(0, 0), {encoded(0.5), encoded(0.25), encoded(0.125), 0xffff}, half_step);
    expect_near(image->pixel(1, 0), {encoded(0.5), encoded(0.25), encoded(0.125), 0x8000}, half_step);
    expect_near(image->pixel(2, 0), {0xffff, 0, encoded(0.002), 0xffff}, half_step);
    expect_near(image->pixel(3, 0), {0, 0xffff, 0xffff, 0xffff}, 0);
    EXPECT_EQ(image->pixel(4, 0)[3], 0);
  }
}

TEST(FloatImage, ExrMayHaveOneChannelOrMoreThanColours) {
  OIIO::ImageSpec grey(2, 1, 1, OIIO::TypeDesc::FLOAT);
  grey.channelnames = {"Y"};
  const auto one = decode_image(write_with_oiio("exr", grey, std::vector<float>{0.5F, 1}), "grey.exr");
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->channels, 1);
  expect_near(one->pixel(0, 0), {encoded(0.5), encoded(0.5), encoded(0.5), 0xffff}, 1);

  OIIO::ImageSpec deep(1, 1, 6, OIIO::TypeDesc::FLOAT);
  deep.channelnames = {"R", "G", "B", "A", "Z", "id"};
  const auto many = decode_image(write_with_oiio("exr", deep, std::vector<float>{0.1F, 0.2F, 0.3F, 1, 77, 5}),
                                 "render.exr");
  ASSERT_TRUE(many) << many.error().message;
  EXPECT_EQ(many->channels, 4);
  expect_near(many->pixel(0, 0), {encoded(0.1F), encoded(0.2F), encoded(0.3F), 0xffff}, 1);
}

TEST(FloatImage, ExrFillsItsDisplayWindow) {
  OIIO::ImageSpec spec(2, 2, 4, OIIO::TypeDesc::FLOAT);
  spec.x = 3;  // The second column lies outside the frame.
  spec.y = 1;
  spec.full_width = spec.full_height = 4;
  const auto image = decode_image(write_with_oiio("exr", spec, std::vector<float>(16, 1.0F)), "part.exr");
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->width, 4);
  ASSERT_EQ(image->height, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(image->pixel(x, y)[3], x == 3 && (y == 1 || y == 2) ? 0xffff : 0) << x << ", " << y;
}

TEST(FloatImage, HdrIsLinearAndClamped) {
  const auto image = decode_image(
      write_with_oiio("hdr", OIIO::ImageSpec(3, 1, 3, OIIO::TypeDesc::FLOAT),
                      std::vector<float>{0.5F, 0.25F, 0.125F, 8, 0.5F, 0, 0.0625F, 0.0625F, 0.0625F}),
      "no extension");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->channels, 3);
  // Its values have 8 bits and a common exponent.
  expect_near(image->pixel(0, 0), {encoded(0.5), encoded(0.25), encoded(0.125), 0xffff}, 256);
  expect_near(image->pixel(1, 0), {0xffff, encoded(0.5), 0, 0xffff}, 512);
  expect_near(image->pixel(2, 0), {encoded(0.0625), encoded(0.0625), encoded(0.0625), 0xffff}, 256);
}

TEST(FloatImage, TiffOfFloatsIsLinearToo) {
  for (const int straight : {0, 1}) {
    OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::FLOAT);
    spec.attribute("oiio:UnassociatedAlpha", straight);
    const float colour = straight != 0 ? 0.5F : 0.25F;
    const auto image =
        decode_image(write_with_oiio("tif", spec, std::vector<float>{colour, 0, colour, 0.5F}), "a.tif");
    ASSERT_TRUE(image) << image.error().message;
    expect_near(image->pixel(0, 0), {encoded(0.5), 0, encoded(0.5), 0x8000}, 1);
  }
}

TEST(Image, TiffWithAlphaMultipliedInBecomesStraight) {
  for (const int straight : {0, 1}) {
    OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:UnassociatedAlpha", straight);
    const auto colour = static_cast<std::uint16_t>(straight != 0 ? 40000 : 20000);
    const auto image = decode_image(
        write_with_oiio("tif", spec, std::vector<std::uint16_t>{colour, 0, colour, 32768}), "a.tif");
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->bits, 16);
    expect_near(image->pixel(0, 0), {40000, 0, 40000, 32768}, 2);
  }
}

/// Smooth colours, with alpha from nothing at the left to all at the right.
Image make_ramp(int channels) {
  Image image = make_image(64, 48, {0, 0, 0, 0xffff});
  image.channels = channels;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      std::uint16_t* p = image.pixel(x, y);
      p[0] = static_cast<std::uint16_t>(257 * 4 * x);
      p[1] = static_cast<std::uint16_t>(channels < 3 ? p[0] : 257 * 5 * y);
      p[2] = static_cast<std::uint16_t>(channels < 3 ? p[0] : 257 * 100);
      if (image.has_alpha()) p[3] = static_cast<std::uint16_t>(257 * std::min(4 * x, 255));
    }
  return image;
}

int worst_difference(const Image& a, const Image& b, bool opaque_only) {
  int worst = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (!opaque_only || a.rgba[i | 3] > 0xf000) worst = std::max(worst, std::abs(a.rgba[i] - b.rgba[i]));
  return worst / 257;
}

TEST(Image, LosslessWebpKeepsEverything) {
  for (const int channels : {3, 4}) {
    const Image image = make_ramp(channels);
    const auto bytes = encode_webp(image, 100);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const auto again = decode_image(*bytes, "a.webp");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->channels, channels);
    EXPECT_EQ(again->rgba, image.rgba) << "colours under transparency too";
  }
}

TEST(Image, QualityTradesBytesForColours) {
  const Image image = make_ramp(4);
  Image opaque = make_ramp(3);
  const auto worst_of = [&](const Result<Bytes>& bytes, const Image& before) {
    const auto again = decode_image(bytes.value(), "again");
    EXPECT_TRUE(again) << again.error().message;
    return worst_difference(before, *again, true);
  };
  EXPECT_LE(worst_of(encode_webp(image, 95), image), 16);
  EXPECT_LE(worst_of(encode_jpeg(opaque, 95), opaque), 12);
  EXPECT_LT(encode_webp(image, 40)->size(), encode_webp(image, 95)->size());
  EXPECT_LT(encode_jpeg(opaque, 40)->size(), encode_jpeg(opaque, 95)->size());
  const auto grey = decode_image(encode_jpeg(make_ramp(2), 95).value(), "grey.jpg");
  ASSERT_TRUE(grey) << grey.error().message;
  EXPECT_EQ(grey->channels, 1) << "JPEG has no alpha";
}

TEST(Image, SixteenBitsAreRoundedToEight) {
  Image image = make_image(1, 1, {0x80ff, 0x7f00, 0xff80, 0xffff});
  image.channels = 3;
  const auto again = decode_image(encode_png(image).value(), "rounded").value();
  EXPECT_EQ(again.pixel(0, 0)[0], 257 * 0x80);
  EXPECT_EQ(again.pixel(0, 0)[1], 257 * 0x7f);
  EXPECT_EQ(again.pixel(0, 0)[2], 257 * 0xff);
}

TEST(Image, TooLargeForWebpIsSaid) {
  const auto bytes = encode_webp(make_image(webp_largest_side + 1, 1, {0, 0, 0, 0xffff}), 90);
  ASSERT_FALSE(bytes);
  EXPECT_NE(bytes.error().message.find("16384 x 1"), std::string::npos) << bytes.error().message;
}

TEST(Image, BrokenFilesOfEveryFormatAreErrors) {
  OIIO::ImageSpec floats(9, 7, 3, OIIO::TypeDesc::FLOAT);
  const std::vector<float> values(9 * 7 * 3, 0.5F);
  const std::vector<Bytes> files = {
      encode_webp(make_ramp(4), 90).value(), encode_webp(make_ramp(3), 100).value(),
      write_with_oiio("exr", floats, values), write_with_oiio("hdr", floats, values)};
  for (const Bytes& file : files)
    for (std::size_t size = 0; size < file.size() - 1; size += 1 + size / 6) {
      const auto image = decode_image(std::span(file).first(size), "cut.bin");
      const std::string message = image ? "'cut.bin'" : image.error().message;
      EXPECT_NE(message.find("'cut.bin'"), std::string::npos) << message;
      // A decoder may make do with less, but never with the header alone.
      EXPECT_FALSE(image && size < 24) << size;
    }
}

}  // namespace
}  // namespace applique
