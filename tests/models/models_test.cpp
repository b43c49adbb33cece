// The whole of it on third-party models: solved, exact, covered, the GPU in step with its twin, the output
// valid.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "applique/gpu/gpu_transfer.h"

#include "bake_job.h"
#include "bake_plan.h"
#include "bake_seams.h"
#include "cli/small_model.h"
#include "decal_layers.h"
#include "edit.h"
#include "gltf/validator.h"
#include "gpu/gpu_fixture.h"
#include "job.h"
#include "models/model_jobs.h"
#include "models/reference_bake.h"
#include "save_document.h"
#include "separate_uvs.h"
#include "solve_job.h"
#include "support/shapes.h"
#include "uv_conflict.h"

namespace applique {
namespace {

SolvedJob solve(const ModelJob& job) {
  auto loaded = load_job(job.file);
  EXPECT_TRUE(loaded) << loaded.error().message;
  auto solved = solve_job(*loaded);
  EXPECT_TRUE(solved) << solved.error().message;
  return std::move(*solved);
}

/// The base colours that the job bakes into.
Result<std::vector<BakeTarget>> plan_base_colours(const SolvedJob& solved) {
  Document document = solved.model.document;
  APPLIQUE_TRY(auto targets, plan_bake(solved, document));
  std::erase_if(targets, [](const BakeTarget& target) { return target.slot != MaterialSlot::base_color; });
  return targets;
}

class Models : public GpuTest {
 protected:
  /// Generates the demo once for all tests.
  static void SetUpTestSuite() {
    GpuTest::SetUpTestSuite();
    folder = std::filesystem::temp_directory_path() / ("applique-models-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const std::string command = std::string(APPLIQUE_ASSETS_COMMAND) + " '" + folder.string() + "' --gallery";
    ASSERT_EQ(std::system(command.c_str()), 0);  // NOLINT: a command of our own
    jobs = {{"bust-mask", folder / "bust-mask.json", false},
            {"bust-emblem", folder / "bust-emblem.json", false},
            {"bottle-label", folder / "bottle-label.json", false}};
    if (std::string(APPLIQUE_TEST_DATA).empty()) {
      std::puts("skipped the third-party models: APPLIQUE_TEST_DATA does not name their folder");
      return;
    }
    for (ModelJob& job : write_model_jobs(APPLIQUE_TEST_DATA, folder)) jobs.push_back(std::move(job));
  }
  static void TearDownTestSuite() {
    std::filesystem::remove_all(folder);
    GpuTest::TearDownTestSuite();
  }

  static inline std::filesystem::path folder;
  static inline std::vector<ModelJob> jobs;
};

TEST_F(Models, AreSolvedExactlyWithoutFlips) {
  for (const ModelJob& job : jobs) {
    SCOPED_TRACE(job.name);
    const SolvedJob solved = solve(job);
    const DecalMap& map = solved.decals[0].map;
    EXPECT_EQ(map.quality.flipped_plane, 0u);
    EXPECT_EQ(map.quality.flipped_image, 0u);
    for (double residual : map.quality.feature_residual) EXPECT_LT(residual, 0.01);
    EXPECT_EQ(map.status, job.surface_ends ? Coverage::clipped_by_boundary : Coverage::covered);
    if (!job.surface_ends) {
      EXPECT_GT(map.quality.coverage, 0.995);
    }
    EXPECT_LT(map.quality.coverage, 1.001);
    RecordProperty(job.name + ".l2", std::to_string(map.quality.l2_stretch));
  }
}

bool contains(const std::array<Vec2, 3>& triangle, Vec2 z) {
  for (int k = 0; k < 3; ++k)
    if (cross(triangle[(k + 1) % 3] - triangle[k], z - triangle[k]) < -1e-9) return false;
  return true;
}

/// Pixels along the face's edge on which a texel is longest in the image.
double texel_size(const TransferFace& face, const ImageFrame& frame) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const double texels =
        std::hypot(face.texel[next][0] - face.texel[k][0], face.texel[next][1] - face.texel[k][1]);
    largest =
        std::max(largest, std::abs(face.image[next] - face.image[k]) * frame.pixels_per_unit() / texels);
  }
  return largest;
}

/// Some texel shows each feature's image point to within a texel's size there.
void expect_features_in_texture(const SolvedJob& solved, const Transfer& transfer,
                                const TransferResult& result) {
  const ImageFrame& frame = transfer.image->frame;
  for (const Feature& feature : solved.decals[0].features) {
    double nearest = 1e9, texel = 0;
    for (const TransferResult::Sample& sample : result.samples)
      nearest =
          std::min(nearest, std::hypot(sample.image.x - feature.image.x, sample.image.y - feature.image.y));
    for (const TransferFace& face : transfer.faces)
      if (contains(face.image, frame.to_plane(feature.image)))
        texel = std::max(texel, texel_size(face, frame));
    EXPECT_GT(texel, 0);
    EXPECT_LT(nearest, texel);
  }
}

TEST_F(Models, BakeOnTheGpuAsOnTheCpu) {
  auto gpu = GpuTransfer::create(device());
  ASSERT_TRUE(gpu) << gpu.error().message;
  for (const ModelJob& job : jobs) {
    SCOPED_TRACE(job.name);
    const SolvedJob solved = solve(job);
    const auto targets = plan_base_colours(solved);
    ASSERT_TRUE(targets) << targets.error().message;
    const DecalImage image = make_decal_image(solved.decals[0].image, solved.decals[0].region);
    for (const BakeTarget& target : *targets) {
      auto before = initial_texture(solved, target);
      ASSERT_TRUE(before) << before.error().message;
      Transfer transfer =
          lay_out_transfer(solved, target, target.shares.front(), before->width, before->height);
      transfer.image = &image;
      Image on_cpu = *before, on_gpu = *before;
      const TransferResult cpu = transfer_on_cpu(transfer, on_cpu, true);
      const auto run = gpu->run(transfer, on_gpu, true);
      ASSERT_TRUE(run) << run.error().message;
      ASSERT_EQ(run->samples.size(), cpu.samples.size());
      double worst = 0;
      for (std::size_t i = 0; i < cpu.samples.size(); ++i) {
        ASSERT_EQ(cpu.samples[i].x, run->samples[i].x);
        ASSERT_EQ(cpu.samples[i].y, run->samples[i].y);
        worst = std::max(worst, std::hypot(cpu.samples[i].image.x - run->samples[i].image.x,
                                           cpu.samples[i].image.y - run->samples[i].image.y));
      }
      EXPECT_LT(worst, 0.05);
      int colour = 0;
      for (std::size_t i = 0; i < on_cpu.rgba.size(); ++i)
        colour = std::max(colour, std::abs(int(on_cpu.rgba[i]) - int(on_gpu.rgba[i])));
      EXPECT_LE(colour, 257);  // one step of 8 bits
      if (targets->size() == 1) expect_features_in_texture(solved, transfer, *run);
    }
  }
}

TEST_F(Models, AreFilteredLikeManySamples) {
  auto gpu = GpuTransfer::create(device());
  ASSERT_TRUE(gpu) << gpu.error().message;
  for (const ModelJob& job : jobs) {
    SCOPED_TRACE(job.name);
    const SolvedJob solved = solve(job);
    if (solved.decals[0].map.sheets > 1) continue;
    const auto targets = plan_base_colours(solved);
    ASSERT_TRUE(targets) << targets.error().message;
    const DecalImage image = make_decal_image(solved.decals[0].image, solved.decals[0].region);
    for (const BakeTarget& target : *targets) {
      auto before = initial_texture(solved, target);
      ASSERT_TRUE(before) << before.error().message;
      Transfer transfer =
          lay_out_transfer(solved, target, target.shares.front(), before->width, before->height);
      transfer.image = &image;
      Image baked = *before;
      const auto run = gpu->run(transfer, baked, true);
      ASSERT_TRUE(run) << run.error().message;
      const BakeQuality quality =
          compare_with_samples(transfer, *before, baked, *run, run->samples.size() / 20000 + 1);
      std::printf("%-16s %6zu texels of %d x %d: %.2f dB, at most %.1f of 255\n", job.name.c_str(),
                  quality.texels, before->width, before->height, quality.psnr, quality.largest);
      EXPECT_GT(quality.psnr, 45);
    }
  }
}

/// Differences across seams, of 255: of the channel that differs most at each place, sorted.
std::vector<double> differences_across(std::span<const Seam> seams, std::span<const SeamTexture> textures,
                                       Encoding encoding = Encoding::colour) {
  std::vector<double> differences;
  for (const SeamSample& sample : sample_seams(seams, textures, encoding)) {
    if (!sample.changed) continue;
    double& worst = differences.emplace_back(0);
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, 255 * std::abs(sample.colours[0][c] - sample.colours[1][c]));
  }
  std::sort(differences.begin(), differences.end());
  return differences;
}

/// A job's base colours with the decal in them, the seams as they come.
struct BakedColours {
  std::vector<BakeTarget> targets;
  DecalImage image;
  std::vector<BakeTransfer> transfers;
  std::vector<TransferResult> runs;
  std::vector<Image> before, after;
  std::vector<Seam> seams;

  [[nodiscard]] std::vector<SeamTexture> textures() {
    std::vector<SeamTexture> list;
    for (std::size_t i = 0; i < after.size(); ++i)
      list.push_back(
          {&after[i], &before[i], transfers[i].wrap_u, transfers[i].wrap_v, {true, true, true, false}});
    return list;
  }
};

void bake_colours(const SolvedJob& solved, const Result<std::vector<BakeTarget>>& targets, GpuTransfer& gpu,
                  BakedColours& baked) {
  ASSERT_TRUE(targets) << targets.error().message;
  baked.targets = *targets;
  baked.image = make_decal_image(solved.decals[0].image, solved.decals[0].region);
  std::vector<SizedTarget> sized;
  for (const BakeTarget& target : baked.targets) {
    auto texture = initial_texture(solved, target);
    ASSERT_TRUE(texture) << texture.error().message;
    baked.before.push_back(*texture);
    baked.transfers.push_back(
        lay_out_transfer(solved, target, target.shares.front(), texture->width, texture->height));
    baked.transfers.back().image = &baked.image;
    sized.push_back({&target, texture->width, texture->height});
    auto run = gpu.run(baked.transfers.back(), *texture, true);
    ASSERT_TRUE(run) << run.error().message;
    baked.runs.push_back(std::move(*run));
    baked.after.push_back(std::move(*texture));
  }
  baked.seams = find_seams(solved, sized);
}

/// Joins the seams. What differs most across them then, of 255.
double join_and_compare(BakedColours& baked, SeamFit fit) {
  join_seams(baked.seams, baked.textures(), Encoding::colour, fit);
  const auto differences = differences_across(baked.seams, baked.textures());
  return differences.empty() ? 0 : differences.back();
}

/// The decal of a job as a relief alone, baked into the normal maps, its seams as they come.
struct BakedRelief {
  std::vector<Image> before, after;
  std::vector<SeamTexture> textures;
  std::vector<Seam> seams;
};

void bake_relief(SolvedJob solved, const DecalLayer& layer, GpuTransfer& gpu, BakedRelief& baked) {
  solved.decals[0].job.layers = {layer};
  Document document = solved.model.document;
  const auto targets = plan_bake(solved, document);
  ASSERT_TRUE(targets) << targets.error().message;
  DecalLayers layers(solved.decals[0]);
  const auto image = layers.image(0);
  ASSERT_TRUE(image) << image.error().message;
  std::vector<SizedTarget> sized;
  std::vector<BakeTransfer> transfers;
  for (const BakeTarget& target : *targets) {
    const auto texture = initial_texture(solved, target);
    ASSERT_TRUE(texture) << texture.error().message;
    baked.before.push_back(*texture);
    transfers.push_back(
        lay_out_transfer(solved, target, target.shares.front(), texture->width, texture->height));
    transfers.back().image = *image;
    sized.push_back({&target, texture->width, texture->height});
    baked.after.push_back(*texture);
    const auto run = gpu.run(transfers.back(), baked.after.back(), false);
    ASSERT_TRUE(run) << run.error().message;
  }
  for (std::size_t i = 0; i < transfers.size(); ++i)
    baked.textures.push_back({&baked.after[i],
                              &baked.before[i],
                              transfers[i].wrap_u,
                              transfers[i].wrap_v,
                              {true, true, true, false}});
  baked.seams = find_seams(solved, sized);
}

/// Waves of the size of some texels, as a normal map.
void write_waves(const std::filesystem::path& file, const Image& like) {
  Image waves = make_image(like.width, like.height, {0, 0, 0, 0xffff});
  for (int y = 0; y < like.height; ++y)
    for (int x = 0; x < like.width; ++x) {
      const Vec3 normal = Vec3(0.5 * std::sin(0.3 * x), 0.5 * std::cos(0.2 * y + 0.1 * x), 1).normalized();
      for (int c = 0; c < 3; ++c)
        waves.pixel(x, y)[c] = static_cast<std::uint16_t>(0xffff * (0.5 + 0.5 * normal[c]));
    }
  write_png(file, waves);
}

/// A job for a ribbon that winds up a pole of that many sides, two triangles each: without texture
/// coordinates, or with an island for each triangle.
std::filesystem::path write_pole_job(const std::filesystem::path& folder, int sides, double turns,
                                     bool islands) {
  constexpr double height = 6, rise = 0.9, around = 2 * std::numbers::pi;  // rise: of a turn
  constexpr int pins = 9, width = 1200, breadth = 80;
  const shapes::Soup tube = shapes::cylinder(sides, 1, 1, height);
  const SurfaceMesh surface = tube.weld();
  SmallMesh pole;
  pole.name = "Pole";
  pole.positions = tube.positions;
  pole.triangles = tube.triangles;
  if (islands) {
    pole.positions.clear();
    pole.triangles.clear();
    const double cell = 1.0 / std::ceil(std::sqrt(2 * sides));
    double u = 0, v = 0;
    for (const auto& corners : tube.triangles) {
      const auto first = static_cast<std::uint32_t>(pole.positions.size());
      for (const std::uint32_t corner : corners) pole.positions.push_back(tube.positions[corner]);
      pole.triangles.push_back({first, first + 1, first + 2});
      for (const auto& [x, y] : {std::pair(0.1, 0.1), {0.9, 0.1}, {0.1, 0.9}})
        pole.uvs.push_back({u + x * cell, v + y * cell});
      u += cell;
      if (u > 0.99) u = 0, v += cell;
    }
  }
  write_small_model(folder / "pole.glb", {pole}, {{"paint", std::nullopt}});
  Image ribbon = make_image(width, breadth, {0, 0, 0, 0xffff});
  for (int y = 0; y < breadth; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        ribbon.pixel(x, y)[c] =
            static_cast<std::uint16_t>(0x7fff * (1 + std::sin(0.05 * (c + 1) * x) * std::cos(0.1 * y)));
  write_png(folder / "ribbon.png", ribbon);
  nlohmann::json features = nlohmann::json::array();
  for (int k = 0; k < pins; ++k) {
    const double along = (k + 0.5) / pins;
    const double angle = 0.2 + along * turns * around;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    const Vec3 at =
        position_of(surface, shapes::nearest(surface, out + Vec3(0, 0, 1.5 + along * turns * rise)));
    features.push_back({{"image", {along * width, breadth / 2.0}}, {"position", {at.x(), at.y(), at.z()}}});
  }
  const std::filesystem::path file = folder / "pole.json";
  std::ofstream(file) << nlohmann::json(
      {{"version", 1},
       {"model", "pole.glb"},
       {"texture_size", 1024},
       {"decals",
        {{{"name", "ribbon"}, {"image", "ribbon.png"}, {"overlap", "stop"}, {"features", features}}}}});
  return file;
}

/// Texture coordinates that are the surface laid flat: the same lengths in all triangles, not mirrored.
void expect_as_on_surface(const ModelPart& part) {
  double shortest = 1e9, longest = 0;
  for (const auto& corners : part.triangles) {
    std::array<Texel, 3> uvs = {};
    for (std::size_t k = 0; k < 3; ++k) uvs[k] = {part.uvs[corners[k]][0], part.uvs[corners[k]][1]};
    EXPECT_LT(doubled_area(uvs), 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const double ratio = std::hypot(uvs[next][0] - uvs[k][0], uvs[next][1] - uvs[k][1]) /
                           (part.positions[corners[next]] - part.positions[corners[k]]).norm();
      shortest = std::min(shortest, ratio);
      longest = std::max(longest, ratio);
    }
  }
  EXPECT_NEAR(longest / shortest, 1, 1e-3);
}

TEST_F(Models, SeamsAreBroughtTogether) {
  auto gpu = GpuTransfer::create(device());
  ASSERT_TRUE(gpu) << gpu.error().message;
  for (const ModelJob& job : jobs) {
    SCOPED_TRACE(job.name);
    const SolvedJob solved = solve(job);
    BakedColours baked;
    ASSERT_NO_FATAL_FAILURE(bake_colours(solved, plan_base_colours(solved), *gpu, baked));
    if (baked.seams.empty()) continue;
    std::vector<Image>& after = baked.after;
    const std::vector<SeamTexture> textures = baked.textures();
    const auto unjoined = differences_across(baked.seams, textures);
    const std::vector<Image> transferred = after;
    join_seams(baked.seams, textures, Encoding::colour);
    const auto joined = differences_across(baked.seams, textures);
    int moved = 0;
    for (std::size_t i = 0; i < after.size(); ++i)
      for (std::size_t k = 0; k < after[i].rgba.size(); ++k)
        moved = std::max(moved, std::abs(after[i].rgba[k] - transferred[i].rgba[k]) / 257);
    const auto at = [](const std::vector<double>& sorted, double share) {
      return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    };
    std::printf(
        "%-16s %4zu seams, %5zu places; of 255, half, 90 %%, 99 %% of them differ by up to %.1f, %.1f, %.1f, "
        "joined %.1f, %.1f, %.1f\n",
        job.name.c_str(), baked.seams.size(), joined.size(), at(unjoined, 0.5), at(unjoined, 0.9),
        at(unjoined, 0.99), at(joined, 0.5), at(joined, 0.9), at(joined, 0.99));
    // The scanned head's texture coordinates are rounded to two texels: along its seams there are slivers.
    const double most = job.name == "tiger" ? 1 : 0.8;
    EXPECT_LE(std::accumulate(joined.begin(), joined.end(), 0.0),
              most * std::accumulate(unjoined.begin(), unjoined.end(), 0.0) + 1);
    EXPECT_LE(joined.back(), unjoined.back() + 1);
    EXPECT_LE(moved, 16);

    after = transferred;
    join_seams(baked.seams, textures, Encoding::colour, SeamFit::exact);
    const auto exact = differences_across(baked.seams, textures);
    std::printf("%-16s joined exactly: at most %.2f of 255, 99 %% %.2f\n", job.name.c_str(), exact.back(),
                at(exact, 0.99));
    EXPECT_LE(exact.back(), 2);
  }
}

/// In one piece both sides of what was a seam are one place of the texture, so that nothing has to give way;
/// what is left is joined. By default, only where nothing else is to be seen of it.
TEST_F(Models, BothSidesOfSeamsShowTheSame) {
  auto gpu = GpuTransfer::create(device());
  ASSERT_TRUE(gpu) << gpu.error().message;
  const std::map<Unwrap, std::set<std::string>> in_one_piece = {
      {Unwrap::unseen, {"bust-emblem", "bottle-label"}},
      {Unwrap::always, {"bust-mask", "bust-emblem", "bottle-label", "water-bottle"}}};
  for (const ModelJob& job : jobs)
    for (const auto& [unwrap, names] : in_one_piece) {
      if (unwrap == Unwrap::always && !names.contains(job.name)) continue;
      SCOPED_TRACE(job.name + (unwrap == Unwrap::always ? ", always" : ""));
      SolvedJob solved = solve(job);
      ASSERT_EQ(solved.job.unwrap, Unwrap::unseen);
      solved.job.unwrap = unwrap;
      const auto separated = separate_uvs(solved);
      ASSERT_TRUE(separated) << separated.error().message;
      BakedColours baked;
      ASSERT_NO_FATAL_FAILURE(bake_colours(solved, plan_base_colours(solved), *gpu, baked));
      if (names.contains(job.name)) {
        ASSERT_FALSE(separated->conflicts.front().empty());
        EXPECT_EQ(separated->conflicts.front().front().reason, "seams");
        EXPECT_EQ(baked.seams.size(), 0U);
      }
      // A decal that winds over itself in the plane takes more than one piece.
      const double worst = join_and_compare(baked, solved.job.seams);
      std::printf("%-16s %s: %4zu seams, at most %.2f of 255 across them\n", job.name.c_str(),
                  unwrap == Unwrap::always ? "unwrapped" : "by default", baked.seams.size(), worst);
      EXPECT_LE(worst, 2);
    }
}

class Poles : public GpuTest {
 protected:
  Poles() { std::filesystem::create_directories(folder_); }
  ~Poles() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("applique-poles-" + std::to_string(getpid()));
};

/// A ribbon round a pole of tall sides: the surface is divided for it, and the sides that it is on are rolled
/// out, where they have no texture coordinates or islands of their own, which leaves a small part of the
/// seams. The islands' sides agree as well.
TEST_F(Poles, SidesThatAreRolledOutShowTheSame) {
  auto gpu = GpuTransfer::create(device());
  ASSERT_TRUE(gpu) << gpu.error().message;
  for (const int sides : {3, 7})
    for (const double turns : {1.6, 2.4}) {
      std::size_t of_islands = 0;
      for (const auto& [islands, unwrap] :
           {std::pair(true, Unwrap::never), {true, Unwrap::unseen}, {false, Unwrap::unseen}}) {
        SCOPED_TRACE(testing::Message() << sides << " sides, " << turns << " turns, islands: " << islands);
        SolvedJob solved = solve({"pole", write_pole_job(folder_, sides, turns, islands), false});
        ASSERT_FALSE(solved.decals[0].surface->corners.empty()) << "not divided";
        solved.job.unwrap = unwrap;
        const auto separated = separate_uvs(solved);
        ASSERT_TRUE(separated) << separated.error().message;
        const bool rolled_out = unwrap == Unwrap::unseen;
        ASSERT_EQ(separated->parts.size(), rolled_out ? 1U : 0U);
        BakedColours baked;
        ASSERT_NO_FATAL_FAILURE(bake_colours(solved, plan_base_colours(solved), *gpu, baked));
        if (rolled_out) {
          expect_as_on_surface(solved.model.parts[separated->parts.front()]);
          EXPECT_LE(4 * baked.seams.size(), of_islands);
        } else {
          of_islands = baked.seams.size();
        }
        const double worst = join_and_compare(baked, solved.job.seams);
        std::printf("pole of %d sides, %.1f turns, %s: %4zu seams, at most %.2f of 255 across them\n", sides,
                    turns, rolled_out ? "rolled out" : "as it is", baked.seams.size(), worst);
        EXPECT_LE(worst, 2);
      }
    }
}

/// Where one column of seams is all that there is, a layout with a column somewhere else is no gain.
TEST_F(Poles, KeepAnIslandThatGoesRound) {
  SolvedJob solved = solve({"pole", write_pole_job(folder_, 7, 1.6, false), false});
  ModelPart& part = solved.model.parts.front();
  ASSERT_TRUE(part.uvs.empty());
  for (const Vec3& p : part.positions)
    part.uvs.push_back({std::atan2(p.y(), p.x()) / (2 * std::numbers::pi) + 0.5, p.z() / 6});
  const auto conflicts = find_uv_conflicts(solved);
  ASSERT_TRUE(conflicts) << conflicts.error().message;
  for (const auto& [group, findings] : *conflicts)
    for (const UvFinding& finding : findings) EXPECT_NE(finding.trouble, UvTrouble::seams);
}

/// Reliefs are in frames of their own on either side. A plane that leans nearly agrees as it comes, which
/// says that both are compared in one frame (a mirrored one would differ by 100); waves agree once they are
/// joined.
TEST_F(Models, ReliefsAgreeAcrossSeams) {
  auto gpu = GpuTransfer::create(device());
  ASSERT_TRUE(gpu) << gpu.error().message;
  std::size_t crossed = 0;
  for (const ModelJob& job : jobs) {
    SCOPED_TRACE(job.name);
    SolvedJob solved = solve(job);
    DecalLayer relief;
    relief.slot = MaterialSlot::normal;
    relief.value = {0.7, 0.6, 0.9};
    BakedRelief leaning;
    ASSERT_NO_FATAL_FAILURE(bake_relief(solved, relief, *gpu, leaning));
    if (leaning.seams.empty()) continue;
    ++crossed;
    const auto as_it_comes = differences_across(leaning.seams, leaning.textures, Encoding::normal);
    relief.value.reset();
    relief.image = folder / "waves.png";
    write_waves(relief.image, solved.decals[0].image);
    BakedRelief waves;
    ASSERT_NO_FATAL_FAILURE(bake_relief(solved, relief, *gpu, waves));
    const auto unjoined = differences_across(waves.seams, waves.textures, Encoding::normal);
    join_seams(waves.seams, waves.textures, Encoding::normal, SeamFit::exact);
    const auto joined = differences_across(waves.seams, waves.textures, Encoding::normal);
    const auto half = [](const std::vector<double>& sorted) { return sorted[sorted.size() / 2]; };
    std::printf(
        "%-16s %4zu seams; of 255, a plane differs by up to %.2f, half of it %.2f, waves by up to %.2f, "
        "joined "
        "%.2f\n",
        job.name.c_str(), waves.seams.size(), as_it_comes.back(), half(as_it_comes), unjoined.back(),
        joined.back());
    // The scanned head's texture coordinates are rounded to two texels: its frames turn within a texel.
    if (job.name != "tiger") {
      EXPECT_LE(half(as_it_comes), 8);
    }
    EXPECT_LE(joined.back(), 2);
  }
  EXPECT_GE(crossed, 3U);
}

TEST_F(Models, TheValidatorFindsNothingNew) {
  auto device = Device::create({});
  ASSERT_TRUE(device) << device.error().message;
  auto baker = create_baker(std::move(*device));
  ASSERT_TRUE(baker) << baker.error().message;
  std::vector<std::filesystem::path> files;
  for (const ModelJob& job : jobs) {
    SCOPED_TRACE(job.name);
    SolvedJob solved = solve(job);
    const auto baked = bake_job(solved, **baker);
    ASSERT_TRUE(baked) << baked.error().message;
    const std::filesystem::path output = folder / (job.name + ".glb");
    const auto saved = save_document(baked->document, output);
    ASSERT_TRUE(saved) << saved.error().message;
    files.push_back(solved.job.model);
    files.push_back(output);
  }
  const auto counts = validate(files);
  if (!counts) GTEST_SKIP() << "the Khronos validator is not installed";
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const auto& [code, count] : (*counts)[2 * i + 1]) {
      const auto before = (*counts)[2 * i].find(code);
      EXPECT_NE(before, (*counts)[2 * i].end()) << jobs[i].name << ": " << code;
    }
}

}  // namespace
}  // namespace applique
