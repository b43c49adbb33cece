#include "applique/image/image.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include <gtest/gtest.h>

namespace applique {
namespace {

const std::filesystem::path data = APPLIQUE_TEST_DATA;

Image random_image(int width, int height, int channels, int bits) {
  Image image = make_image(width, height, {0, 0, 0, 0xffff});
  image.channels = channels;
  image.bits = bits;
  std::mt19937 random(static_cast<unsigned>(width * 31 + channels + bits));
  const auto value = [&] {
    return static_cast<std::uint16_t>(bits == 8 ? (random() & 255) * 257 : random() & 0xffff);
  };
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    image.rgba[i] = image.rgba[i + 1] = image.rgba[i + 2] = value();
    if (channels >= 3) image.rgba[i + 1] = value(), image.rgba[i + 2] = value();
    if (image.has_alpha()) image.rgba[i + 3] = value();
  }
  return image;
}

TEST(Image, PngRoundTripKeepsEveryBit) {
  for (const int channels : {1, 2, 3, 4}) {
    for (const int bits : {8, 16}) {
      const Image image = random_image(37, 21, channels, bits);
      const auto bytes = encode_png(image);
      ASSERT_TRUE(bytes) << bytes.error().message;
      const auto again = decode_image(*bytes, "round trip");
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(again->width, 37);
      EXPECT_EQ(again->height, 21);
      EXPECT_EQ(again->channels, channels);
      EXPECT_EQ(again->bits, bits);
      EXPECT_EQ(again->rgba, image.rgba) << channels << " channels, " << bits << " bits";
    }
  }
}

TEST(Image, EncodingIsDeterministic) {
  const Image image = random_image(64, 64, 4, 8);
  EXPECT_EQ(*encode_png(image), *encode_png(image));
}

TEST(Image, ColourUnderTransparencyStaysStraight) {
  const Image image = make_image(3, 3, {200 * 257, 100 * 257, 50 * 257, 257});
  EXPECT_EQ(decode_image(*encode_png(image), "straight")->rgba, image.rgba);
}

TEST(Image, BrokenFilesAreNamed) {
  const auto bytes = *encode_png(random_image(50, 40, 4, 8));
  for (std::size_t size = 0; size < bytes.size() - 12; size += 1 + size / 4) {
    const auto image = decode_image(std::span(bytes).first(size), "cut.png");
    ASSERT_FALSE(image) << size;
    EXPECT_EQ(image.error().code, ErrorCode::image_invalid);
    EXPECT_NE(image.error().message.find("'cut.png'"), std::string::npos) << image.error().message;
  }
  const auto missing = read_image("no such file.png");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::file_unreadable);
  EXPECT_NE(missing.error().message.find("No such file"), std::string::npos) << missing.error().message;
  const std::string text = "not an image at all";
  const auto junk =
      decode_image({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "junk.txt");
  ASSERT_FALSE(junk);
  EXPECT_EQ(junk.error().code, ErrorCode::image_invalid);
}

TEST(Image, ReadsTheFormatsOfTheCollection) {
  if (data.empty()) GTEST_SKIP() << "needs the third-party images: set APPLIQUE_TEST_DATA";
  const auto jpeg = read_image(data / "images/formats/test.jpg");
  ASSERT_TRUE(jpeg) << jpeg.error().message;
  EXPECT_EQ(jpeg->channels, 3);
  EXPECT_EQ(jpeg->bits, 8);
  EXPECT_EQ(jpeg->pixel(0, 0)[3], 0xffff);
  const auto webp = read_image(data / "images/formats/test-lossless.webp");
  ASSERT_TRUE(webp) << webp.error().message;
  const auto palette = read_image(data / "images/mediapipe/glasses_uvtex.png");  // Palette with tRNS.
  ASSERT_TRUE(palette) << palette.error().message;
  EXPECT_EQ(palette->channels, 4);
  bool transparent = false, opaque = false, partly = false;
  for (std::size_t i = 3; i < palette->rgba.size(); i += 4) {
    (palette->rgba[i] == 0 ? transparent : palette->rgba[i] == 0xffff ? opaque : partly) = true;
  }
  EXPECT_TRUE(transparent && opaque && partly);
  for (const char* name : {"2d_uastc.ktx2", "2d_etc1s.ktx2"}) {
    const auto ktx = read_image(data / "images/formats" / name);
    ASSERT_FALSE(ktx);
    EXPECT_EQ(ktx.error().code, ErrorCode::image_invalid);
    EXPECT_NE(ktx.error().message.find("KTX"), std::string::npos) << ktx.error().message;
  }
}

}  // namespace
}  // namespace applique
