#include "applique/transfer/transfer.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "applique/transfer/divide.h"
#include "applique/transfer/raster.h"
#include "applique/transfer/refine.h"

#include "gpu/synthetic_transfer.h"

namespace applique {
namespace {

constexpr std::uint16_t full = 65535;

// An opaque image of one linear colour, or whatever `pixel(x, y)` gives.
template <class PixelAt>
DecalImage make_decal(int width, int height, PixelAt pixel) {
  DecalImage image;
  image.frame = {static_cast<double>(width), static_cast<double>(height)};
  auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  image.levels.push_back({0, w, h});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.texels.push_back(pixel(x, y));
  }
  while (w > 1 || h > 1) {  // Sizes are powers of two here.
    const DecalImage::Level finer = image.levels.back();
    w = std::max(1u, w / 2), h = std::max(1u, h / 2);
    image.levels.push_back({static_cast<std::uint32_t>(image.texels.size()), w, h});
    for (std::uint32_t y = 0; y < h; ++y) {
      for (std::uint32_t x = 0; x < w; ++x) {
        std::array<float, 4> mean{};
        for (std::uint32_t k = 0; k < 4; ++k) {
          const auto& t = image.texels[finer.offset + (2 * y + k / 2) * finer.width + 2 * x + k % 2];
          for (int c = 0; c < 4; ++c) mean[c] += 0.25F * t[c];
        }
        image.texels.push_back(mean);
      }
    }
  }
  return image;
}

DecalImage plain_decal(std::array<float, 4> premultiplied) {
  return make_decal(64, 64, [&](int, int) { return premultiplied; });
}

// A face whose corners lie at the texels `t` and the pixels `p`.
TransferFace face_at(const DecalImage& image, std::array<Texel, 3> t, std::array<Pixel, 3> p) {
  TransferFace face;
  face.texel = t;
  for (int k = 0; k < 3; ++k) face.plane[k] = face.image[k] = image.frame.to_plane(p[k]);
  return face;
}

// Two faces that lay the whole image over a rectangle of the texture.
Transfer rectangle(const DecalImage& image, double x0, double y0, double x1, double y1) {
  const double w = image.frame.width, h = image.frame.height;
  Transfer transfer;
  transfer.image = &image;
  transfer.faces = {face_at(image, {{{x0, y0}, {x1, y0}, {x1, y1}}}, {{{0, 0}, {w, 0}, {w, h}}}),
                    face_at(image, {{{x0, y0}, {x1, y1}, {x0, y1}}}, {{{0, 0}, {w, h}, {0, h}}})};
  return transfer;
}

// How often the jobs of a plan cover each texel of the region.
std::vector<int> coverage(const TilePlan& plan) {
  std::vector<int> count(static_cast<std::size_t>(plan.region.width) * plan.region.height);
  for (const shader::RasterJob& job : plan.jobs) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        bool inside = true;
        for (int k = 0; k < 3; ++k) inside &= job.a[k] * x + job.b[k] * y + job.c[k] >= 0;
        const int tx = x + static_cast<int>(job.x), ty = y + static_cast<int>(job.y);
        if (inside && tx < plan.region.width && ty < plan.region.height) {
          ++count[static_cast<std::size_t>(ty) * plan.region.width + tx];
        }
      }
    }
  }
  return count;
}

TEST(Raster, FacesAroundAVertexCoverEachTexelOnce) {
  std::mt19937 random(1);
  const DecalImage image = plain_decal({1, 1, 1, 1});
  for (int round = 0; round < 50; ++round) {
    // A fan over the square [10, 90], its centre often exactly on a texel's centre, so that edges run through
    // centres.
    const double shift = round % 2 == 0 ? 0.5 : 0.001 * static_cast<double>(random() % 1000);
    const Texel centre = {30 + static_cast<double>(random() % 40) + shift,
                          30 + static_cast<double>(random() % 40) + shift};
    std::vector<Texel> ring;
    for (int k = 0; k < 8; ++k) {
      constexpr double around[8][2] = {{10, 10}, {50.5, 10}, {90, 10}, {90, 50.5},
                                       {90, 90}, {50.5, 90}, {10, 90}, {10, 50.5}};
      ring.push_back({around[k][0], around[k][1]});
    }
    Transfer transfer;
    transfer.image = &image;
    transfer.wrap_u = transfer.wrap_v = WrapMode::clamp;  // No copies in the region's margin.
    for (int k = 0; k < 8; ++k) {
      std::array<Texel, 3> corners = {centre, ring[k], ring[(k + 1) % 8]};
      if (random() % 2) std::swap(corners[0], corners[1]);  // Either orientation.
      transfer.faces.push_back(face_at(image, corners, {{{0, 0}, {1, 0}, {0, 1}}}));
    }
    const TilePlan plan = plan_tile(transfer, shown_parts(transfer), 100, 100, {0, 0, 100, 100});
    const std::vector<int> count = coverage(plan);
    for (int y = 0; y < plan.region.height; ++y) {
      for (int x = 0; x < plan.region.width; ++x) {
        const int tx = x + plan.region.x, ty = y + plan.region.y;
        const bool inside = tx >= 10 && tx < 90 && ty >= 10 && ty < 90;
        ASSERT_EQ(count[static_cast<std::size_t>(y) * plan.region.width + x], inside ? 1 : 0)
            << tx << ", " << ty;
      }
    }
  }
}

TEST(Raster, FacesFarAwayOrWithoutAnAreaAreLeftOut) {
  const DecalImage image = plain_decal({1, 1, 1, 1});
  Transfer transfer;
  transfer.image = &image;
  const double nan = std::nan("");
  transfer.faces = {face_at(image, {{{5, 5}, {20, 20}, {10, 10}}}, {{{0, 0}, {1, 0}, {0, 1}}}),
                    face_at(image, {{{nan, 5}, {20, 20}, {10, 30}}}, {{{0, 0}, {1, 0}, {0, 1}}}),
                    face_at(image, {{{0, 0}, {1e7, 0}, {0, 1e7}}}, {{{0, 0}, {1, 0}, {0, 1}}})};
  EXPECT_TRUE(plan_tile(transfer, shown_parts(transfer), 64, 64, {0, 0, 64, 64}).jobs.empty());
}

TEST(Footprint, IsTheTexelsParallelogram) {
  const DecalImage image = plain_decal({1, 1, 1, 1});
  const auto footprint = [&](double sx, double sy) {
    const Transfer transfer = rectangle(image, 0, 0, 64 / sx, 64 / sy);
    const TilePlan plan = plan_tile(transfer, shown_parts(transfer), 64, 64, {0, 0, 64, 64});
    return place_face(transfer, plan.placements[0]).footprint;
  };
  using Probes = std::array<int, 2>;
  EXPECT_EQ(footprint(1, 1).probes, (Probes{1, 1}));  // Copied.
  EXPECT_EQ(footprint(0.25, 0.25).probes, (Probes{1, 1}));
  EXPECT_EQ(footprint(0.25, 0.25).level, 0);
  EXPECT_EQ(footprint(4, 4).probes, (Probes{8, 8}));
  EXPECT_EQ(footprint(4, 4).level, 0);
  EXPECT_EQ(footprint(8, 8).level, 1);
  EXPECT_EQ(footprint(8, 1).probes, (Probes{16, 2}));
  EXPECT_NEAR(footprint(8, 1).along_x[0], 8, 1e-9);
  EXPECT_NEAR(footprint(1, 8).along_y[1], 8, 1e-9);
  EXPECT_EQ(footprint(64, 2).probes, (Probes{32, 1}));
  EXPECT_EQ(footprint(64, 2).level, 2);
}

TEST(TransferOnCpu, ReproducesTheImagePixelByPixel) {
  std::mt19937 random(2);
  Image expected = make_image(64, 64, {0, 0, 0, full});
  const DecalImage image = make_decal(64, 64, [&](int x, int y) {
    std::array<float, 4> texel = {0, 0, 0, 1};
    for (int c = 0; c < 3; ++c) {
      expected.pixel(x, y)[c] = static_cast<std::uint16_t>((random() & 255) * 257);
      texel[c] = static_cast<float>(srgb_to_linear(expected.pixel(x, y)[c] / 65535.0));
    }
    return texel;
  });
  Image texture = make_image(100, 100, {9 * 257, 80 * 257, 33 * 257, full});
  const Image before = texture;
  Transfer transfer = rectangle(image, 20, 30, 84, 94);
  transfer.gutter = 0;
  const TransferResult result = transfer_on_cpu(transfer, texture, true);
  EXPECT_EQ(result.covered_texels, 64U * 64U);
  EXPECT_EQ(result.gutter_texels, 0U);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const bool inside = x >= 20 && x < 84 && y >= 30 && y < 94;
      for (int c = 0; c < 4; ++c) {
        ASSERT_EQ(texture.pixel(x, y)[c], inside ? expected.pixel(x - 20, y - 30)[c] : before.pixel(x, y)[c]);
      }
    }
  }
  for (const auto& sample : result.samples) {
    ASSERT_NEAR(sample.image.x, sample.x - 20 + 0.5, 1e-9);
    ASSERT_NEAR(sample.image.y, sample.y - 30 + 0.5, 1e-9);
  }
}

TEST(TransferOnCpu, RefinedFacesStayNearTheWarp) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SyntheticOptions options;
    options.texture = 300;
    options.image = 500 * static_cast<int>(seed);
    options.features = 2 + static_cast<int>(seed);
    options.grid = 1 + static_cast<int>(seed);
    options.nonlinear = 1;
    const SyntheticTransfer synthetic = synthetic_transfer(seed, options);
    const Transfer& transfer = synthetic.transfer;
    const auto refined = refine_faces(transfer, shown_parts(transfer));
    EXPECT_TRUE(
        std::any_of(refined.begin(), refined.end(), [](const RefinedFace& f) { return f.cells > 0; }));
    double worst = 0;
    for (std::size_t i = 0; i < refined.size(); ++i) {
      const TransferFace& face = transfer.faces[i];
      for (int k = 0; k < 1000 && refined[i].cells > 0; ++k) {
        const double v = std::fmod(k * 0.7548776662466927, 1),
                     u = (1 - v) * std::fmod(k * 0.5698402909980532, 1);
        const Vec2 p =
            face.plane[0] + u * (face.plane[1] - face.plane[0]) + v * (face.plane[2] - face.plane[0]);
        const Pixel exact = transfer.image->frame.to_pixel((*transfer.warp)(p));
        const Pixel pixel = refined[i].at(u * refined[i].cells, v * refined[i].cells);
        worst = std::max(worst, std::hypot(pixel.x - exact.x, pixel.y - exact.y));
      }
    }
    EXPECT_LT(worst, 0.02) << seed;
  }
}

TEST(TransferOnCpu, TheGutterGoesOnWhereTheFaceEnds) {
  // A ramp along x of which the faces show the middle: the gutter shows what lies beyond.
  const DecalImage image = make_decal(128, 128, [](int x, int) {
    const auto value = static_cast<float>(srgb_to_linear(x / 255.0));
    return std::array<float, 4>{value, value, value, 1};
  });
  Transfer transfer;
  transfer.image = &image;
  transfer.gutter = 6;
  transfer.faces = {face_at(image, {{{40, 40}, {80, 40}, {80, 80}}}, {{{40, 40}, {80, 40}, {80, 80}}}),
                    face_at(image, {{{40, 40}, {80, 80}, {40, 80}}}, {{{40, 40}, {80, 80}, {40, 80}}})};
  Image texture = make_image(128, 128, {full, 0, 0, full});
  const TransferResult result = transfer_on_cpu(transfer, texture);
  EXPECT_GT(result.gutter_texels, 4U * 40 * 6);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      const int dx = std::max({40 - x, x - 79, 0}), dy = std::max({40 - y, y - 79, 0});
      const bool written = dx * dx + dy * dy <= 36;
      ASSERT_EQ(texture.pixel(x, y)[1], written ? x * 257 : 0) << x << ", " << y;
    }
  }
}

// A small image in the middle of a large square of two triangles, placed at random: only blocks near it are
// drawn, and the texture is what it is when the square is cut into faces too small to be left out in part.
// Beside it a face that shows the image up to its edge may not go on into the square.
TEST(TransferOnCpu, OnlyWhatShowsTheImageOfALargeFaceIsDrawn) {
  constexpr int side = 512, pieces = 8;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto ramps = [](bool soft) {
    return make_decal(64, 64, [&](int x, int y) {
      const float u = static_cast<float>(x) / 63, v = static_cast<float>(y) / 63;
      const float alpha = soft ? 16 * u * (1 - u) * v * (1 - v) : 1;
      return std::array<float, 4>{alpha * u, alpha * v, alpha * 0.5F, alpha};
    });
  };
  const DecalImage sharp = ramps(false), soft = ramps(true);
  for (int round = 0; round < 12; ++round) {
    // What is filtered goes by the face's corners: where a warp bends the faces, the image has no sharp rim.
    const bool warped = round >= 6;
    const DecalImage& image = warped ? soft : sharp;
    const Warp warp = random_warp(random, 3 + round % 3, 1);
    const double angle = 6.3 * unit(random), size = (warped ? 64 : 16) + (warped ? 6 : 30) * unit(random);
    const std::array<double, 2> middle = {120 + 200 * unit(random), 120 + 200 * unit(random)};
    const auto pixel_at = [&](const Texel& t) {
      const double x = (t[0] - middle[0]) / size, y = (t[1] - middle[1]) / size;
      return Pixel{32 + 64 * (std::cos(angle) * x + std::sin(angle) * y),
                   32 + 64 * (-std::sin(angle) * x + std::cos(angle) * y)};
    };
    const auto bent = [&](TransferFace face) {
      if (!warped) return face;
      for (std::size_t k = 0; k < 3; ++k) face.image[k] = warp(face.plane[k]);
      face.linear = false;
      return face;
    };
    const auto square = [&](double x, double y, double width, std::vector<TransferFace>& faces) {
      const std::array<Texel, 4> t = {{{x, y}, {x + width, y}, {x + width, y + width}, {x, y + width}}};
      for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}})
        faces.push_back(
            bent(face_at(image, {{t[a], t[b], t[c]}}, {{pixel_at(t[a]), pixel_at(t[b]), pixel_at(t[c])}})));
    };
    Transfer large, small;
    if (warped) large.warp = small.warp = &warp;
    if (warped) large.gutter = small.gutter = 2;
    large.image = small.image = &image;
    constexpr double low = 4, width = 496;
    square(low, low, width, large.faces);
    for (int i = 0; i < pieces * pieces; ++i)
      square(low + width / pieces * (i % pieces), low + width / pieces * (i / pieces), width / pieces,
             small.faces);
    const TransferFace neighbour =
        face_at(image, {{{500, 4}, {510, 4}, {500, 500}}}, {{{0, 0}, {64, 0}, {0, 64}}});
    large.faces.push_back(neighbour);
    small.faces.push_back(neighbour);
    Image drawn = make_image(side, side, {full / 4, full / 4, full / 4, full}), expected = drawn;
    const TransferResult result = transfer_on_cpu(large, drawn);
    const TransferResult whole = transfer_on_cpu(small, expected);
    EXPECT_LT((warped ? 1.2 : 5) * static_cast<double>(result.covered_texels),
              static_cast<double>(whole.covered_texels));
    EXPECT_EQ(result.shared_texels, 0U);
    int painted = 0;
    for (std::size_t i = 0; i < drawn.rgba.size(); ++i) {
      // A refined face is within 0.02 pixel of the warp.
      ASSERT_NEAR(drawn.rgba[i], expected.rgba[i], warped ? 2000 : 257)
          << "round " << round << ", value " << i;
      painted += i % 4 == 2 && drawn.rgba[i] != full / 4;
    }
    EXPECT_GT(painted, 200);
  }
}

// The parts of divided faces make up these, and lie where the warp has them; what is small or linear stays.
TEST(TransferOnCpu, LargeBentFacesAreDivided) {
  SyntheticOptions options;
  options.texture = 600;
  options.image = 500;
  options.features = 4;
  options.grid = 2;
  options.nonlinear = 1;
  const SyntheticTransfer synthetic = synthetic_transfer(5, options);
  Transfer transfer = synthetic.transfer;
  const auto area = [](const Transfer& of) {
    double sum = 0;
    for (const TransferFace& face : of.faces) sum += 0.5 * std::abs(doubled_area(face.texel));
    return sum;
  };
  const auto divided = divide_faces(transfer);
  ASSERT_TRUE(divided.has_value());
  EXPECT_GT(divided->faces.size(), 8 * transfer.faces.size());
  EXPECT_NEAR(area(*divided), area(transfer), 1e-6 * area(transfer));
  for (const TransferFace& face : divided->faces)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(std::abs((*transfer.warp)(face.plane[k]) - face.image[k]), 1e-9);
  EXPECT_FALSE(divide_faces(*divided).has_value());
  for (TransferFace& face : transfer.faces) face.linear = true;
  EXPECT_FALSE(divide_faces(transfer).has_value());
}

TEST(TransferOnCpu, InfluenceIsInterpolatedBetweenTheCorners) {
  for (const int grid : {2, 30}) {  // Refined; the warp at each texel.
    SyntheticOptions options;
    options.texture = 128;
    options.grid = grid;
    options.groups = 3;
    options.features = 9;
    options.sheets = 2;
    options.stacked = true;
    options.nonlinear = 1;
    const SyntheticTransfer synthetic = synthetic_transfer(3, options);
    const Transfer& transfer = synthetic.transfer;
    for (std::size_t i = 0; i < transfer.faces.size(); ++i) {
      constexpr std::array<std::array<double, 2>, 3> corners = {{{0, 0}, {1, 0}, {0, 1}}};
      for (int k = 0; k < 3; ++k) {
        const Pixel at = warp_in_face(transfer, i, corners[k][0], corners[k][1]);
        const Pixel expected = transfer.image->frame.to_pixel(transfer.faces[i].image[k]);
        ASSERT_NEAR(at.x, expected.x, 1e-9);
        ASSERT_NEAR(at.y, expected.y, 1e-9);
      }
    }
    // Each sample against the warp at its place in the face that contains it.
    Image texture = noise_texture(1, 128, 128);
    const TransferResult result = transfer_on_cpu(transfer, texture, true);
    double worst = 0;
    std::size_t found = 0;
    for (std::size_t s = 0; s < result.samples.size(); s += 2) {
      const auto& sample = result.samples[s];
      for (std::size_t i = 0; i < transfer.faces.size(); ++i) {
        const auto& t = transfer.faces[i].texel;
        if (transfer.faces[i].sheet != sample.sheet) continue;
        const Vec2 origin(t[0][0], t[0][1]), p = Vec2(sample.x + 0.5, sample.y + 0.5) - origin;
        const Vec2 a = Vec2(t[1][0], t[1][1]) - origin, b = Vec2(t[2][0], t[2][1]) - origin;
        const double u = cross(p, b) / cross(a, b), v = cross(a, p) / cross(a, b);
        if (u < 0.01 || v < 0.01 || u + v > 0.99) continue;
        std::vector<double> influence;
        for (std::size_t g = 0; g < 3; ++g) {
          const double* corner = &transfer.influence[9 * i + g];
          influence.push_back((1 - u - v) * corner[0] + u * corner[3] + v * corner[6]);
        }
        const auto& plane = transfer.faces[i].plane;
        const Pixel exact = transfer.image->frame.to_pixel(
            (*transfer.warp)((1 - u - v) * plane[0] + u * plane[1] + v * plane[2], influence));
        worst = std::max(worst, std::hypot(exact.x - sample.image.x, exact.y - sample.image.y));
        ++found;
      }
    }
    EXPECT_GT(found, 2000U);
    EXPECT_LT(worst, grid == 2 ? 0.02 : 1e-9);
  }
}

// The lower sheet shows red over all of [8, 24] x [8, 24], the upper one over the left half of it what goes
// from green above to nothing below.
struct StackedSheets {
  DecalImage image = make_decal(64, 64, [](int x, int y) {
    if (x >= 32) return std::array<float, 4>{1, 0, 0, 1};
    return y < 24   ? std::array<float, 4>{0, 1, 0, 1}
           : y < 40 ? std::array<float, 4>{0, 0.5F, 0, 0.5F}
                    : std::array<float, 4>{};
  });
  Transfer transfer;

  StackedSheets() {
    transfer.image = &image;
    transfer.gutter = 4;
    const auto quad = [&](double x0, double x1, double left, double right, std::uint32_t sheet) {
      for (const bool second : {false, true}) {
        TransferFace face =
            second ? face_at(image, {{{x0, 8}, {x1, 24}, {x0, 24}}}, {{{left, 16}, {right, 48}, {left, 48}}})
                   : face_at(image, {{{x0, 8}, {x1, 8}, {x1, 24}}}, {{{left, 16}, {right, 16}, {right, 48}}});
        face.sheet = sheet;
        transfer.faces.push_back(face);
      }
    };
    quad(8, 16, 8, 24, 1);
    quad(8, 16, 40, 56, 0);
    quad(16, 24, 40, 56, 0);
  }
};

TEST(TransferOnCpu, TheLowerSheetShowsThroughTheUpper) {
  const StackedSheets sheets;
  Image texture = make_image(32, 32, {0, 0, full, full});
  const TransferResult result = transfer_on_cpu(sheets.transfer, texture, true);
  EXPECT_EQ(result.covered_texels, 16U * 16 + 8 * 16);  // Once for every sheet.
  EXPECT_EQ(result.samples.size(), result.covered_texels);
  EXPECT_EQ(result.shared_texels, 0U);
  const auto expect_texel = [&](int x, int y, double red, double green, double blue) {
    const std::array<double, 3> linear = {red, green, blue};
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(texture.pixel(x, y)[c], 257 * std::lround(255 * linear_to_srgb(linear[c])))
          << x << ", " << y << ", " << c;
  };
  for (const int x : {8, 11, 14}) {
    expect_texel(x, 9, 0, 1, 0);
    expect_texel(x, 15, 0.5, 0.5, 0);  // Both.
    expect_texel(x, 22, 1, 0, 0);
  }
  // Where the upper one ends and the lower goes on, there is no gutter; around the island, each has its own.
  for (const int y : {9, 15, 22}) expect_texel(17, y, 1, 0, 0);
  expect_texel(11, 6, 0, 1, 0);
  expect_texel(20, 6, 1, 0, 0);
  expect_texel(17, 5, 1, 0, 0);  // In reach of the upper sheet, but nearer to what only the lower one has.
  expect_texel(6, 22, 1, 0, 0);
  expect_texel(6, 2, 0, 0, 1);
}

TEST(TransferOnCpu, SheetsAreNotUvOverlapButForeignSurfaceIs) {
  StackedSheets sheets;
  sheets.transfer.foreign = {{{{8, 20}, {24, 20}, {24, 30}}}, {{{8, 20}, {24, 30}, {8, 30}}}};
  Image texture = make_image(32, 32, {0, 0, full, full});
  const TransferResult result = transfer_on_cpu(sheets.transfer, texture);
  EXPECT_EQ(result.shared_texels, 4U * 16 + 4 * 8);  // Once for every sheet.
  EXPECT_EQ(texture.pixel(10, 25)[2], full);         // No gutter over it.
}

TEST(TransferOnCpu, CopiesAreUvOverlapButKeepNoGutterOut) {
  StackedSheets plain, copied;
  copied.transfer.copies = {{{{8, 20}, {24, 20}, {24, 30}}}, {{{8, 20}, {24, 30}, {8, 30}}}};
  Image without = make_image(32, 32, {0, 0, full, full}), with = without;
  const TransferResult result = transfer_on_cpu(plain.transfer, without);
  EXPECT_EQ(result.shared_texels, 0U);
  EXPECT_EQ(transfer_on_cpu(copied.transfer, with).shared_texels, 4U * 16 + 4 * 8);
  EXPECT_EQ(without.pixel(10, 25)[2], 0);  // The gutter.
  EXPECT_EQ(with.rgba, without.rgba);
}

TEST(TransferOnCpu, TheUpperSheetWinsWhateverTheOrder) {
  const DecalImage image = make_decal(64, 64, [](int x, int) {
    return x < 32 ? std::array<float, 4>{1, 0, 0, 1} : std::array<float, 4>{0, 1, 0, 1};
  });
  TransferFace red = face_at(image, {{{0, 0}, {32, 0}, {0, 32}}}, {{{4, 4}, {20, 4}, {4, 20}}});
  TransferFace green = face_at(image, {{{0, 0}, {32, 0}, {0, 32}}}, {{{40, 4}, {56, 4}, {40, 20}}});
  for (const bool swapped : {false, true}) {
    red.sheet = 1;
    Transfer transfer;
    transfer.image = &image;
    transfer.faces = swapped ? std::vector{green, red} : std::vector{red, green};
    Image texture = make_image(32, 32, {0, 0, full, full});
    transfer_on_cpu(transfer, texture);
    EXPECT_EQ(texture.pixel(5, 5)[0], full);
    EXPECT_EQ(texture.pixel(5, 5)[1], 0);
  }
}

TEST(TransferOnCpu, LeavesTexelsWithoutColourAlone) {
  std::mt19937 random(3);
  Image texture = make_image(64, 64, {});
  for (std::uint16_t& value : texture.rgba) value = static_cast<std::uint16_t>(random());
  texture.bits = 16;
  const Image before = texture;
  const DecalImage clear = plain_decal({0, 0, 0, 0});
  transfer_on_cpu(rectangle(clear, 0, 0, 64, 64), texture);
  EXPECT_EQ(texture.rgba, before.rgba);
  const DecalImage white = plain_decal({1, 1, 1, 1});
  Transfer faint = rectangle(white, 0, 0, 64, 64);
  faint.opacity = 0;
  transfer_on_cpu(faint, texture);
  EXPECT_EQ(texture.rgba, before.rgba);
}

// The colour (linear) of a texture of one colour after a decal of one colour.
std::array<double, 4> blended(std::array<float, 4> premultiplied, std::array<double, 4> below, BlendMode mode,
                              bool opaque) {
  const DecalImage image = plain_decal(premultiplied);
  std::array<std::uint16_t, 4> stored{};
  for (int c = 0; c < 4; ++c) {
    stored[c] =
        static_cast<std::uint16_t>(std::lround(65535 * (c < 3 ? linear_to_srgb(below[c]) : below[c])));
  }
  Image texture = make_image(64, 64, stored);
  texture.bits = 16;
  Transfer transfer = rectangle(image, 0, 0, 64, 64);
  transfer.blend = mode;
  transfer.opaque = opaque;
  transfer_on_cpu(transfer, texture);
  std::array<double, 4> result{};
  for (int c = 0; c < 4; ++c) {
    const double value = texture.pixel(32, 32)[c] / 65535.0;
    result[c] = c < 3 ? srgb_to_linear(value) : value;
  }
  return result;
}

TEST(TransferOnCpu, BlendsInLinearLight) {
  const std::array<float, 4> half_red = {0.4F, 0, 0, 0.5F};  // Straight red 0.8.
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 1}, BlendMode::normal, true)[0], 0.4 + 0.5 * 0.2, 1e-4);
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 1}, BlendMode::normal, true)[1], 0.5 * 0.6, 1e-4);
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 1}, BlendMode::multiply, true)[0], 0.5 * 0.8 * 0.2 + 0.5 * 0.2,
              1e-4);
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 1}, BlendMode::screen, true)[0],
              0.5 * (0.8 + 0.2 - 0.16) + 0.5 * 0.2, 1e-4);
  // Over a clear texel the decal shows its own colour, unless the texture's alpha does not show.
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 0}, BlendMode::normal, false)[0], 0.8, 1e-4);
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 0}, BlendMode::normal, false)[3], 0.5, 1e-4);
  EXPECT_NEAR(blended(half_red, {0.2, 0.6, 0, 0}, BlendMode::normal, true)[0], 0.4 + 0.5 * 0.2, 1e-4);
}

TEST(TransferOnCpu, MinifiesToTheMean) {
  // A checkerboard of single pixels, four to a texel and more.
  const DecalImage image = make_decal(256, 256, [](int x, int y) {
    const float value = (x + y) % 2 ? 1.0F : 0.0F;
    return std::array<float, 4>{value, value, value, 1};
  });
  for (const double side : {64.0, 37.0, 20.0}) {
    Image texture = make_image(64, 64, {0, 0, 0, full});
    transfer_on_cpu(rectangle(image, 0, 0, side, side), texture);
    for (int x = 5; x < 15; ++x) {
      EXPECT_NEAR(srgb_to_linear(texture.pixel(x, 10)[0] / 65535.0), 0.5, 0.01) << side;
    }
  }
}

}  // namespace
}  // namespace applique
