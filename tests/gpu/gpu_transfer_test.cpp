#include "applique/gpu/gpu_transfer.h"

#include <chrono>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "gpu/gpu_fixture.h"
#include "gpu/synthetic_transfer.h"

namespace applique {
namespace {

using GpuTransferTest = GpuTest;

struct Agreement {
  double pixels = 0;  // Largest distance of image points.
  int levels = 0;     // Largest difference of a channel, of 255, where the texel is not fully transparent.
  std::size_t samples = 0;
  std::size_t changed = 0;
  std::size_t off = 0;  ///< Values that differ by more than a level.
};

// Runs both twins on the same texture and compares them texel by texel.
Agreement compare(GpuTransfer& gpu, const Transfer& transfer, const Image& texture) {
  Image on_gpu = texture, on_cpu = texture;
  const auto gpu_result = gpu.run(transfer, on_gpu, true);
  const TransferResult cpu_result = transfer_on_cpu(transfer, on_cpu, true);
  Agreement agreement;
  if (!gpu_result) {
    ADD_FAILURE() << gpu_result.error().message;
    return agreement;
  }
  EXPECT_EQ(gpu_result->covered_texels, cpu_result.covered_texels);
  EXPECT_EQ(gpu_result->gutter_texels, cpu_result.gutter_texels);
  EXPECT_EQ(gpu_result->shared_texels, cpu_result.shared_texels);
  EXPECT_EQ(on_gpu.channels, on_cpu.channels);
  EXPECT_EQ(cpu_result.samples.size(), cpu_result.covered_texels);
  if (gpu_result->samples.size() != cpu_result.samples.size()) {
    ADD_FAILURE() << "samples: " << gpu_result->samples.size() << " and " << cpu_result.samples.size();
    return agreement;
  }
  agreement.samples = cpu_result.samples.size();
  for (std::size_t i = 0; i < agreement.samples; ++i) {
    const auto &a = gpu_result->samples[i], &b = cpu_result.samples[i];
    if (a.x != b.x || a.y != b.y || a.sheet != b.sheet) {
      ADD_FAILURE() << "sample " << i << " is at another texel";
      return agreement;
    }
    agreement.pixels = std::max(agreement.pixels, std::hypot(a.image.x - b.image.x, a.image.y - b.image.y));
  }
  for (std::size_t i = 0; i < texture.rgba.size(); ++i) {
    const bool shows = transfer.opaque || i % 4 == 3 || on_cpu.rgba[i / 4 * 4 + 3] > 0;
    const int levels = static_cast<int>(std::lround(std::abs(on_gpu.rgba[i] - on_cpu.rgba[i]) / 257.0));
    if (shows) agreement.levels = std::max(agreement.levels, levels);
    if (shows && levels > 1) ++agreement.off;
    if (on_cpu.rgba[i] != texture.rgba[i]) ++agreement.changed;
  }
  return agreement;
}

void expect_agreement(const Agreement& agreement) {
  EXPECT_GT(agreement.samples, 1000U);
  EXPECT_GT(agreement.changed, 1000U);
  EXPECT_LT(agreement.pixels, 0.005);
  EXPECT_LE(agreement.levels, 1);
}

/// For what divides by numbers that may be near zero: there the half floats show that the device's image has.
void expect_rare_differences(const Agreement& agreement) {
  EXPECT_GT(agreement.samples, 1000U);
  EXPECT_GT(agreement.changed, 1000U);
  EXPECT_LT(static_cast<double>(agreement.off), 1e-3 * static_cast<double>(agreement.changed));
}

TEST_F(GpuTransferTest, AgreesWithTheCpuOnRandomTransfers) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  double worst = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SyntheticOptions options;
    options.features = 3 + static_cast<int>(seed) % 8;
    options.image = 60 * static_cast<int>(seed * seed);
    options.sheets = 1 + static_cast<int>(seed) % 3;
    options.nonlinear = seed == 1 ? 0 : 0.5;
    options.texture = 200 + 17 * static_cast<int>(seed);
    SyntheticTransfer synthetic = synthetic_transfer(seed, options);
    synthetic.transfer.blend = static_cast<BlendMode>(seed % 6);
    synthetic.transfer.opaque = seed % 2 == 0;
    synthetic.transfer.opacity = seed % 4 == 0 ? 0.6 : 1;
    const int bits = seed % 3 == 0 ? 16 : 8;
    const Agreement agreement =
        compare(gpu, synthetic.transfer, noise_texture(seed, options.texture, options.texture, bits));
    SCOPED_TRACE(seed);
    expect_agreement(agreement);
    worst = std::max(worst, agreement.pixels);
  }
  RecordProperty("worst_pixels", std::to_string(worst));
}

TEST_F(GpuTransferTest, AgreesInEveryBlendMode) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  for (unsigned mode = 0; mode <= static_cast<unsigned>(BlendMode::erase); ++mode) {
    SCOPED_TRACE(mode);
    SyntheticTransfer synthetic = synthetic_transfer(mode, {});
    synthetic.transfer.blend = static_cast<BlendMode>(mode);
    synthetic.transfer.opaque = mode % 2 == 0;
    const Agreement agreement = compare(gpu, synthetic.transfer, noise_texture(mode, 256, 256));
    const BlendMode blend = synthetic.transfer.blend;
    const bool divides = blend == BlendMode::color_dodge || blend == BlendMode::color_burn ||
                         blend == BlendMode::hue || blend == BlendMode::saturation;
    divides ? expect_rare_differences(agreement) : expect_agreement(agreement);
  }
}

TEST_F(GpuTransferTest, AgreesOnDataAndNormals) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    SyntheticTransfer synthetic = synthetic_transfer(seed, {});
    Transfer& transfer = synthetic.transfer;
    transfer.encoding = seed % 2 == 0 ? Encoding::normal : Encoding::data;
    transfer.blend = seed % 4 < 2 ? BlendMode::normal : BlendMode::add;
    transfer.channels = {seed != 1, true, seed != 3, false};
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-3, 3);
    for (TransferFace& face : transfer.faces) {
      face.along = {std::polar(1.0, any(random)), std::polar(2.0, any(random)), std::polar(1.5, any(random))};
      face.reversed = any(random) > 0;
    }
    const int bits = seed < 4 ? 8 : 16;
    const Image before = noise_texture(seed, 256, 256, bits);
    const Agreement agreement = compare(gpu, transfer, before);
    transfer.encoding == Encoding::normal ? expect_rare_differences(agreement) : expect_agreement(agreement);
    Image after = before;
    ASSERT_TRUE(gpu.run(transfer, after));
    for (std::size_t i = 0; i < after.rgba.size(); ++i) {
      if (!transfer.channels[i % 4]) {
        ASSERT_EQ(after.rgba[i], before.rgba[i]);
      }
    }
  }
}

TEST_F(GpuTransferTest, AgreesWhereTheWarpRunsAtEachTexel) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  SyntheticOptions options;
  options.grid = 40;  // Too few texels to a face to refine it.
  options.texture = 128;
  options.nonlinear = 1;
  for (const int features : {3, 8, 16}) {  // 16: the tables do not fit into the smallest uniform buffer.
    options.features = features;
    options.image = 100 * features;
    SCOPED_TRACE(features);
    expect_agreement(compare(gpu, synthetic_transfer(5, options).transfer, noise_texture(1, 128, 128)));
  }
}

/// Both twins of a mirrored transfer find the same pixels, which are those of the plain one turned over.
TEST_F(GpuTransferTest, MirrorsLikeTheCpu) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  for (const int grid : {2, 8, 40}) {  // Refined faces, some of each, the warp at each texel.
    SyntheticOptions options;
    options.grid = grid;
    SyntheticTransfer synthetic = synthetic_transfer(6, options);
    Image plain_texture = noise_texture(1, 256, 256);
    const auto plain = gpu.run(synthetic.transfer, plain_texture, true);
    synthetic.image->frame.mirrored = true;
    SCOPED_TRACE(grid);
    expect_agreement(compare(gpu, synthetic.transfer, noise_texture(1, 256, 256)));
    Image texture = noise_texture(1, 256, 256);
    const auto mirrored = gpu.run(synthetic.transfer, texture, true);
    ASSERT_TRUE(plain && mirrored);
    ASSERT_EQ(mirrored->samples.size(), plain->samples.size());
    for (std::size_t i = 0; i < plain->samples.size(); ++i) {
      ASSERT_NEAR(mirrored->samples[i].image.x, options.image - plain->samples[i].image.x, 0.005);
      ASSERT_NEAR(mirrored->samples[i].image.y, plain->samples[i].image.y, 0.005);
    }
  }
}

/// The image's 600 x 600 pixels take 3.8 MB: four pieces and, where the tiles are cut as well, 59.
TEST_F(GpuTransferTest, GoesThroughALargeImageInPieces) {
  for (const std::uint64_t bytes : {1U << 20, 1U << 16}) {
    GpuTransferOptions gpu_options;
    gpu_options.max_buffer_bytes = bytes;
    GpuTransfer gpu = GpuTransfer::create(device(), gpu_options).value();
    SyntheticOptions options;
    options.image = 600;
    options.texture = 200;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      options.sheets = static_cast<int>(seed);
      options.stacked = seed > 1;
      SyntheticTransfer synthetic = synthetic_transfer(seed, options);
      synthetic.transfer.blend = static_cast<BlendMode>(seed % 6);
      SCOPED_TRACE(seed);
      expect_agreement(compare(gpu, synthetic.transfer, noise_texture(seed, 200, 200)));
    }
  }
}

TEST_F(GpuTransferTest, RefinesCoarseFaces) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  SyntheticOptions options;
  options.grid = 2;
  options.texture = 400;
  options.image = 2000;
  options.nonlinear = 1;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    expect_agreement(compare(gpu, synthetic_transfer(seed, options).transfer, noise_texture(1, 400, 400)));
  }
}

TEST_F(GpuTransferTest, AgreesWhereTheRegionOverlapsItself) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SyntheticOptions options;
    options.stacked = true;
    options.sheets = 2 + static_cast<int>(seed) % 2;
    options.groups = 2 + static_cast<int>(seed) / 2 % 2;
    options.features = seed == 7 ? 18 : 3 * options.groups;  // 18: large tables.
    options.grid = seed % 2 == 0 ? 40 : 3;                   // The warp at each texel; refined.
    options.image = 200 + 100 * static_cast<int>(seed);
    options.nonlinear = 0.7;
    SyntheticTransfer synthetic = synthetic_transfer(seed, options);
    synthetic.transfer.blend = static_cast<BlendMode>(seed % 6);
    synthetic.transfer.opaque = seed % 4 < 2;
    synthetic.transfer.opacity = seed % 3 == 0 ? 0.6 : 1;
    SCOPED_TRACE(seed);
    const Image texture = noise_texture(seed, 256, 256, seed == 5 ? 16 : 8);
    expect_agreement(compare(gpu, synthetic.transfer, texture));
  }
}

TEST_F(GpuTransferTest, ManyGroupsNeedNoBound) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  SyntheticOptions options;
  options.groups = 40;
  options.features = 80;
  options.grid = 40;
  options.texture = 64;
  options.nonlinear = 0.3;
  expect_agreement(compare(gpu, synthetic_transfer(1, options).transfer, noise_texture(1, 64, 64)));
}

TEST_F(GpuTransferTest, WrapsFacesOverTheBorder) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  for (const WrapMode mode : {WrapMode::repeat, WrapMode::mirror, WrapMode::clamp}) {
    SyntheticOptions options;
    options.centre = -0.9;  // Around the corner, a period away.
    options.texture = 150;
    SyntheticTransfer synthetic = synthetic_transfer(2, options);
    synthetic.transfer.wrap_u = mode;
    if (mode == WrapMode::clamp) {
      for (TransferFace& face : synthetic.transfer.faces) {
        for (Texel& texel : face.texel) texel = {texel[0] + 150, texel[1] + 150};
      }
    }
    SCOPED_TRACE(static_cast<int>(mode));
    expect_agreement(compare(gpu, synthetic.transfer, noise_texture(3, 150, 150)));
  }
}

TEST_F(GpuTransferTest, MovingByAPeriodChangesNothing) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  SyntheticOptions options;
  options.texture = 128;  // A power of two: moving by it is exact.
  SyntheticTransfer synthetic = synthetic_transfer(4, options);
  const Image texture = noise_texture(3, 128, 128);
  Image here = texture, there = texture;
  ASSERT_TRUE(gpu.run(synthetic.transfer, here));
  for (TransferFace& face : synthetic.transfer.faces) {
    for (Texel& texel : face.texel) texel = {texel[0] + 256, texel[1] - 128};
  }
  ASSERT_TRUE(gpu.run(synthetic.transfer, there));
  EXPECT_NE(here.rgba, texture.rgba);
  EXPECT_EQ(here.rgba, there.rgba);
}

TEST_F(GpuTransferTest, TinyTilesGiveTheSameBits) {
  GpuTransfer whole = GpuTransfer::create(device()).value();
  GpuTransfer tiled = GpuTransfer::create(device(), {37}).value();
  SyntheticOptions options;
  options.sheets = 2;
  options.centre = 0.1;
  const SyntheticTransfer synthetic = synthetic_transfer(9, options);
  Image a = noise_texture(7, 256, 256), b = a;
  const TransferResult result_a = whole.run(synthetic.transfer, a, true).value();
  const TransferResult result_b = tiled.run(synthetic.transfer, b, true).value();
  EXPECT_EQ(result_a.covered_texels, result_b.covered_texels);
  EXPECT_EQ(result_a.gutter_texels, result_b.gutter_texels);
  EXPECT_EQ(result_a.samples.size(), result_b.samples.size());
  EXPECT_EQ(a.rgba, b.rgba);
}

TEST_F(GpuTransferTest, ForeignTrianglesKeepTheirTexels) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  SyntheticOptions options;
  SyntheticTransfer synthetic = synthetic_transfer(6, options);
  // The lower sixth of the texture is foreign, partly over the faces; and a triangle in the gutter.
  synthetic.transfer.foreign = {{{{0, 210}, {256, 210}, {256, 256}}}, {{{0, 210}, {256, 256}, {0, 256}}}};
  const Image texture = noise_texture(5, 256, 256);
  expect_agreement(compare(gpu, synthetic.transfer, texture));
  Image result = texture;
  const TransferResult outcome = gpu.run(synthetic.transfer, result, true).value();
  std::map<std::pair<int, int>, bool> covered;
  for (const auto& sample : outcome.samples) covered[{sample.x, sample.y}] = true;
  std::size_t shared = 0;
  for (int y = 210; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      if (covered.count({x, y})) {
        ++shared;
      } else {
        for (int c = 0; c < 4; ++c) EXPECT_EQ(result.pixel(x, y)[c], texture.pixel(x, y)[c]);
      }
    }
  }
  EXPECT_EQ(outcome.shared_texels, shared);
}

TEST_F(GpuTransferTest, CopiesShareTheFacesTexelsOnly) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  const Image texture = noise_texture(5, 256, 256);
  SyntheticTransfer synthetic = synthetic_transfer(6, {});
  Image plain = texture, copied = texture;
  ASSERT_TRUE(gpu.run(synthetic.transfer, plain));
  synthetic.transfer.copies = {{{{0, 210}, {256, 210}, {256, 256}}}, {{{0, 210}, {256, 256}, {0, 256}}}};
  expect_agreement(compare(gpu, synthetic.transfer, texture));
  EXPECT_GT(gpu.run(synthetic.transfer, copied).value().shared_texels, 100U);
  EXPECT_EQ(plain.rgba, copied.rgba);
  // What is foreign besides keeps its texels.
  synthetic.transfer.foreign = synthetic.transfer.copies;
  expect_agreement(compare(gpu, synthetic.transfer, texture));
}

TEST_F(GpuTransferTest, GreyTexturesTakeColour) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  Image texture = make_image(256, 256, {30000 / 257 * 257, 30000 / 257 * 257, 30000 / 257 * 257, 65535});
  texture.channels = 1;
  expect_agreement(compare(gpu, synthetic_transfer(1, {}).transfer, texture));
  ASSERT_TRUE(gpu.run(synthetic_transfer(1, {}).transfer, texture));
  EXPECT_EQ(texture.channels, 3);
}

TEST_F(GpuTransferTest, NothingToDoIsNoError) {
  GpuTransfer gpu = GpuTransfer::create(device()).value();
  SyntheticTransfer synthetic = synthetic_transfer(1, {});
  synthetic.transfer.faces.clear();
  Image texture = noise_texture(1, 64, 64);
  const Image before = texture;
  const TransferResult result = gpu.run(synthetic.transfer, texture).value();
  EXPECT_EQ(result.covered_texels, 0U);
  EXPECT_EQ(texture.rgba, before.rgba);
}

}  // namespace
}  // namespace applique
