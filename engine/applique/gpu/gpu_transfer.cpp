#include "applique/gpu/gpu_transfer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <tuple>

#include "applique/transfer/divide.h"
#include "applique/transfer/raster.h"
#include "applique/transfer/refine.h"

#include "transfer_cover.spv.h"
#include "transfer_nearest.spv.h"
#include "transfer_shade.spv.h"
#include "transfer_shade_large.spv.h"

namespace applique {
namespace {

constexpr VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;

struct Tables {
  std::array<shader::uvec4, shader::max_levels> levels;
  std::array<shader::vec4, shader::warp_table_capacity> warp;
};
static_assert(sizeof(Tables) <= 16384);

struct WorkCounts {
  std::uint32_t covered, gutter, shared, padding;
};

// The buffer of what a tile changes: counts, texels, then samples and the sums of the decal's pieces where
// asked for.
struct WorkLayout {
  std::size_t samples = 0, sums = 0, words = 0;  // In words of 8 bytes after the counts.

  WorkLayout(std::size_t texels, bool has_samples, bool has_sums)
      : samples(texels),
        sums(samples + (has_samples ? texels : 0)),
        words(sums + (has_sums ? 2 * texels : 0)) {}
  [[nodiscard]] std::size_t bytes() const { return sizeof(WorkCounts) + words * sizeof(shader::uvec2); }
};

// The buffer of what the shading pass only reads.
class Plan {
 public:
  // Appends; returns where the items begin.
  template <class Item>
  std::uint32_t add(std::span<const Item> items) {
    const std::size_t first = words_.size();
    words_.resize(first + (items.size_bytes() + sizeof(shader::uvec4) - 1) / sizeof(shader::uvec4));
    if (!items.empty()) std::memcpy(&words_[first], items.data(), items.size_bytes());
    return static_cast<std::uint32_t>(first);
  }
  [[nodiscard]] const std::vector<shader::uvec4>& words() const { return words_; }

 private:
  std::vector<shader::uvec4> words_;
};

// Rounds to nearest, ties to even; values are 0 to 1.
std::uint16_t to_half(float value) {
  constexpr float smallest_normal = 6.103515625e-05F;
  if (value <= 0) return 0;
  if (value < smallest_normal) return static_cast<std::uint16_t>(std::lround(value * 16777216.0F));
  const auto bits = std::bit_cast<std::uint32_t>(value) - (112U << 23);
  return static_cast<std::uint16_t>((bits + 0xfffU + (bits >> 13 & 1U)) >> 13);
}

// All levels from `first` on.
std::vector<std::uint16_t> packed_levels(const DecalImage& image, std::size_t first) {
  std::vector<std::uint16_t> halves;
  halves.reserve(4 * (image.texels.size() - image.levels[first].offset));
  for (std::size_t i = image.levels[first].offset; i < image.texels.size(); ++i) {
    for (const float channel : image.texels[i]) halves.push_back(to_half(channel));
  }
  return halves;
}

// As the shader reads it: pairs, positions and groups by stage, rates by stage.
std::vector<shader::vec4> warp_table(const Warp& warp) {
  std::vector<shader::vec4> table;
  table.reserve(warp.pairs.size() + warp.position.size() + warp.lambda.size());
  for (const auto& [i, j] : warp.pairs)
    table.push_back({std::bit_cast<float>(i), std::bit_cast<float>(j), 0, 0});
  for (std::size_t i = 0; i < warp.position.size(); ++i) {
    const Vec2 p = warp.position[i];
    const std::uint32_t group = warp.groups > 1 ? warp.group[i % warp.features] : 0;
    table.push_back(
        {static_cast<float>(p.real()), static_cast<float>(p.imag()), std::bit_cast<float>(group), 0});
  }
  for (std::size_t q = 0; q < warp.lambda.size(); ++q) {
    table.push_back({static_cast<float>(warp.lambda[q].real()), static_cast<float>(warp.lambda[q].imag()),
                     static_cast<float>(warp.offset[q].real()), static_cast<float>(warp.offset[q].imag())});
  }
  return table;
}

shader::vec2 to_floats(const std::array<double, 2>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1])};
}

// Adds what a warp with groups is told in a face: by corner the plane point, then, for every two groups, by
// corner their influence.
void add_places(const Transfer& transfer, std::size_t face, std::vector<shader::vec2>& points) {
  for (const Vec2 p : transfer.faces[face].plane) points.push_back(to_floats({p.real(), p.imag()}));
  const std::size_t groups = transfer.warp->groups;
  for (std::size_t g = 0; g < groups; g += 2)
    for (std::size_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const double* influence = &transfer.influence[corner * groups];
      points.push_back(to_floats({influence[g], g + 1 < groups ? influence[g + 1] : 0}));
    }
}

// `points` takes the face's grid, if it has one.
shader::FaceMap to_face_map(const Transfer& transfer, std::size_t index, const PlacedFace& face,
                            const RefinedFace& refined, std::vector<shader::vec2>& points) {
  shader::FaceMap map{};
  std::array<double, 2> value = face.map.value;
  map.texel = {face.map.origin[0], face.map.origin[1]};
  if (!face.warped) {
    for (int i = 0; i < 2; ++i) {
      map.pixel[i] = static_cast<std::int32_t>(std::floor(value[i]));
      value[i] -= map.pixel[i];
    }
  }
  map.value = to_floats(value);
  map.dx = to_floats(face.map.dx);
  map.dy = to_floats(face.map.dy);
  map.along_x = to_floats(face.footprint.along_x);
  map.along_y = to_floats(face.footprint.along_y);
  map.level = static_cast<std::uint32_t>(face.footprint.level);
  for (std::size_t k = 0; k < 2; ++k) map.probes[k] = static_cast<std::uint32_t>(face.footprint.probes[k]);
  map.flags = face.clamped ? shader::face_clamped : 0;
  if (transfer.encoding == Encoding::normal)
    for (const auto& along : {face.along.value, face.along.dx, face.along.dy})
      points.push_back(to_floats(along));
  map.first_point = static_cast<std::uint32_t>(points.size());
  if (refined.cells > 0) {
    map.flags |= static_cast<std::uint32_t>(refined.cells) * shader::face_cells;
    map.pixel = {static_cast<std::int32_t>(std::floor(refined.points[0].x)),
                 static_cast<std::int32_t>(std::floor(refined.points[0].y))};
    for (const Pixel& p : refined.points)
      points.push_back(to_floats({p.x - map.pixel[0], p.y - map.pixel[1]}));
  } else if (face.warped) {
    map.flags |= shader::face_warped;
    if (transfer.warp->groups > 1) add_places(transfer, index, points);
  }
  if (transfer.faces[index].reversed) map.flags |= shader::face_reversed;
  return map;
}

// Some of them are empty where the tile is one texel wide or high.
std::array<TexelRect, 4> quarters(const TexelRect& tile) {
  const int left = (tile.width + 1) / 2, top = (tile.height + 1) / 2;
  const int right = tile.width - left, bottom = tile.height - top;
  return {{{tile.x, tile.y, left, top},
           {tile.x + left, tile.y, right, top},
           {tile.x, tile.y + top, left, bottom},
           {tile.x + left, tile.y + top, right, bottom}}};
}

// Orders the passes: what one writes, the next reads.
void barrier(const Device& device, VkCommandBuffer commands, VkPipelineStageFlags from,
             VkAccessFlags written) {
  VkMemoryBarrier memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  memory.srcAccessMask = written;
  memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_HOST_READ_BIT;
  device.functions().vkCmdPipelineBarrier(commands, from,
                                          VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_HOST_BIT,
                                          0, 1, &memory, 0, nullptr, 0, nullptr);
}

}  // namespace

// One call of run(): what its tiles have in common.
struct GpuTransfer::Run {
  const Transfer& transfer;
  Image& texture;
  bool keep_samples;
  int bits;  // To round to.
  TransferResult result{};
  std::vector<Buffer> decal{};  // The levels' texels, in as many pieces as the largest buffer asks for.
  std::size_t first_level = 0;  // In `decal`, once that is there.
  std::vector<shader::vec4> table{};

  std::vector<std::optional<TexelBounds>> shown{};  // By face.
  std::vector<RefinedFace> refined{};               // By face; not cut where linear.

  Result<void> upload_decal(const Device& device, std::size_t needed_level, std::size_t piece_texels);
};

Result<void> GpuTransfer::Run::upload_decal(const Device& device, std::size_t needed_level,
                                            std::size_t piece_texels) {
  if (!decal.empty() && first_level <= needed_level) return {};
  const std::vector<std::uint16_t> halves = packed_levels(*transfer.image, needed_level);
  decal.clear();
  for (std::size_t first = 0; first < halves.size(); first += 4 * piece_texels) {
    const auto piece = std::span(halves).subspan(first, std::min(4 * piece_texels, halves.size() - first));
    APPLIQUE_TRY(decal.emplace_back(), make_buffer(device, "decal image", piece, storage));
  }
  first_level = needed_level;
  return {};
}

Result<GpuTransfer> GpuTransfer::create(const Device& device, const GpuTransferOptions& options) {
  GpuTransfer result;
  result.device_ = &device;
  result.options_ = options;
  result.options_.tile = std::clamp(options.tile, 8, 16384);
  const std::uint64_t device_limit = device.properties().limits.maxStorageBufferRange;
  result.options_.max_buffer_bytes =
      options.max_buffer_bytes == 0 ? device_limit
                                    : std::clamp<std::uint64_t>(options.max_buffer_bytes, 4096, device_limit);
  APPLIQUE_TRY(
      result.cover_,
      ComputePipeline::create(
          device,
          {"transfer cover", applique_spirv_transfer_cover, {0, 1}, {}, sizeof(shader::TransferConstants)}));
  APPLIQUE_TRY(result.nearest_, ComputePipeline::create(device, {"transfer nearest",
                                                                 applique_spirv_transfer_nearest,
                                                                 {0, 1},
                                                                 {},
                                                                 sizeof(shader::TransferConstants)}));
  return result;
}

Result<const ComputePipeline*> GpuTransfer::shading_pipeline(Shading shading, std::uint32_t groups) {
  auto found = shade_.find({shading, groups});
  if (found == shade_.end()) {
    ComputePipelineInfo info{"transfer shade",
                             applique_spirv_transfer_shade,
                             {0, 1, 2, 3},
                             {4},
                             sizeof(shader::TransferConstants),
                             {shading != Shading::linear ? 1U : 0U, groups}};
    if (shading == Shading::large_warp) info.spirv = applique_spirv_transfer_shade_large;
    APPLIQUE_TRY(ComputePipeline pipeline, ComputePipeline::create(*device_, info));
    found = shade_.emplace(std::pair(shading, groups), std::move(pipeline)).first;
  }
  return &found->second;
}

Result<TransferResult> GpuTransfer::run(const Transfer& transfer, Image& texture, bool keep_samples) {
  if (const auto divided = divide_faces(transfer)) return run(*divided, texture, keep_samples);
  const std::vector<std::uint32_t> sheets = sheets_of(transfer);
  Run run{transfer, texture, keep_samples, working_bits(texture, sheets.size())};
  run.shown = shown_parts(transfer);
  run.refined = refine_faces(transfer, run.shown);
  if (transfer.warp && transfer.warp->steps > 0) run.table = warp_table(*transfer.warp);
  for (const std::uint32_t sheet : sheets) {
    for (int y = 0; y < texture.height; y += options_.tile) {
      for (int x = 0; x < texture.width; x += options_.tile) {
        APPLIQUE_CHECK(run_tile(
            run, sheet,
            {x, y, std::min(options_.tile, texture.width - x), std::min(options_.tile, texture.height - y)}));
      }
    }
  }
  if (run.bits != texture.bits) round_to_8_bits(texture);
  std::sort(run.result.samples.begin(), run.result.samples.end(), [](const auto& a, const auto& b) {
    return std::tie(a.sheet, a.y, a.x) < std::tie(b.sheet, b.y, b.x);
  });
  if (texture.channels < 3 && run.result.covered_texels + run.result.gutter_texels > 0) texture.channels += 2;
  return run.result;
}

Result<void> GpuTransfer::run_tile(Run& run, std::uint32_t sheet, const TexelRect& tile) {
  const Device& device = *device_;
  const Transfer& transfer = run.transfer;
  TilePlan plan = plan_tile(transfer, run.shown, run.texture.width, run.texture.height, tile, sheet);
  if (plan.jobs.empty()) return {};
  const TexelRect &work = plan.work, &region = plan.region;
  const std::size_t foreign_first = plan.jobs.size();
  plan.jobs.insert(plan.jobs.end(), plan.foreign_jobs.begin(), plan.foreign_jobs.end());

  std::vector<shader::FaceMap> faces;
  faces.reserve(plan.placements.size());
  std::vector<shader::vec2> points;
  std::size_t finest = shader::max_levels;
  bool warped = false;
  for (const Placement& placement : plan.placements) {
    const RefinedFace& refined = run.refined[placement.face];
    const PlacedFace face = place_face(transfer, placement, refined.cells);
    faces.push_back(to_face_map(transfer, placement.face, face, refined, points));
    finest = std::min(finest, static_cast<std::size_t>(face.footprint.level));
    warped |= face.warped && refined.cells == 0;
  }
  const std::size_t piece_texels = options_.max_buffer_bytes / (4 * sizeof(std::uint16_t));
  APPLIQUE_CHECK(run.upload_decal(device, finest, piece_texels));
  // What does not fit into the device's buffers is done in smaller pieces.
  const std::size_t work_texels = static_cast<std::size_t>(work.width) * work.height;
  const std::size_t region_texels = static_cast<std::size_t>(region.width) * region.height;
  const WorkLayout work_layout(work_texels, run.keep_samples, run.decal.size() > 1);
  // A large warp's table is in every tile's plan. Its share of a true device's 128 MiB is small.
  const std::size_t room =
      options_.max_buffer_bytes -
      std::min<std::size_t>(options_.max_buffer_bytes / 2, std::span(run.table).size_bytes());
  const std::size_t plan_bytes =
      4 * plan.blocks.size() + std::span(faces).size_bytes() + std::span(points).size_bytes();
  const std::size_t largest =
      std::max({work_layout.bytes(), 8 * region_texels, std::span(plan.jobs).size_bytes()});
  if ((largest > options_.max_buffer_bytes || plan_bytes > room) && std::max(tile.width, tile.height) > 1) {
    for (const TexelRect& part : quarters(tile))
      if (part.width > 0 && part.height > 0) APPLIQUE_CHECK(run_tile(run, sheet, part));
    return {};
  }

  const Shading shading = !warped                                           ? Shading::linear
                          : run.table.size() <= shader::warp_table_capacity ? Shading::warped
                                                                            : Shading::large_warp;
  APPLIQUE_TRY(const ComputePipeline* shade, shading_pipeline(shading, warped ? transfer.warp->groups : 1));

  const DecalImage& image = *transfer.image;
  std::vector<Tables> tables(1);
  for (std::size_t k = run.first_level; k < std::min<std::size_t>(image.levels.size(), shader::max_levels);
       ++k) {
    const DecalImage::Level& level = image.levels[k];
    tables[0].levels[k] = {level.offset - image.levels[run.first_level].offset, level.width, level.height, 0};
  }
  if (shading == Shading::warped) std::copy(run.table.begin(), run.table.end(), tables[0].warp.begin());

  shader::TransferConstants constants{};
  Plan shading_plan;
  shading_plan.add<std::uint32_t>(plan.blocks);  // First, as the shader has it.
  constants.plan_faces = shading_plan.add<shader::FaceMap>(faces);
  constants.plan_points = shading_plan.add<shader::vec2>(points);
  if (shading == Shading::large_warp) constants.plan_warp = shading_plan.add<shader::vec4>(run.table);

  constants.work_samples = static_cast<std::uint32_t>(work_layout.samples);
  constants.work_sums = static_cast<std::uint32_t>(work_layout.sums);
  std::vector<std::byte> work_bytes(work_layout.bytes());
  const std::span<std::byte> texels = std::span(work_bytes).subspan(sizeof(WorkCounts), 8 * work_texels);
  const std::span<std::byte> samples = std::span(work_bytes)
                                           .subspan(sizeof(WorkCounts) + 8 * work_layout.samples,
                                                    8 * (work_layout.sums - work_layout.samples));
  std::fill(samples.begin(), samples.end(), std::byte{0xff});  // NaN
  const std::size_t row = 8 * static_cast<std::size_t>(work.width);
  for (int y = 0; y < work.height; ++y)
    std::memcpy(&texels[y * row], run.texture.pixel(work.x, work.y + y), row);

  APPLIQUE_TRY(const Buffer region_buffer, Buffer::create(device, "region", 8 * region_texels, storage));
  APPLIQUE_TRY(const Buffer job_buffer, make_buffer(device, "jobs", plan.jobs, storage));
  APPLIQUE_TRY(const Buffer near_block_buffer,
               make_buffer(device, "nearest blocks", plan.nearest_blocks, storage));
  APPLIQUE_TRY(const Buffer plan_buffer, make_buffer(device, "plan", shading_plan.words(), storage));
  APPLIQUE_TRY(const Buffer work_buffer, make_buffer(device, "work", work_bytes, storage));
  APPLIQUE_TRY(const Buffer table_buffer,
               make_buffer(device, "tables", tables, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT));

  constants.region_size = {region.width, region.height};
  constants.work_origin = {work.x - region.x, work.y - region.y};
  constants.work_size = {work.width, work.height};
  constants.gutter = static_cast<std::int32_t>(std::min(transfer.gutter, 255u));
  constants.opacity = static_cast<float>(transfer.opacity);
  constants.blend = static_cast<std::uint32_t>(transfer.blend);
  constants.opaque = transfer.opaque ? 1 : 0;
  constants.encoding = static_cast<std::uint32_t>(transfer.encoding);
  for (std::uint32_t c = 0; c < 4; ++c) constants.channels |= transfer.channels[c] ? 1U << c : 0;
  constants.max_value = run.bits == 8 ? 255.0F : 65535.0F;
  constants.keep_samples = run.keep_samples ? 1 : 0;
  if (warped) {
    constants.steps = transfer.warp->steps;
    constants.features = transfer.warp->features;
    constants.pairs = static_cast<std::uint32_t>(transfer.warp->pairs.size());
  }
  constants.half_size = to_floats({0.5 * image.frame.width, 0.5 * image.frame.height});
  constants.pixels_per_unit = to_floats({image.frame.pixels_along_x(), -image.frame.pixels_per_unit()});

  cover_.bind({{0, &region_buffer}, {1, &job_buffer}});
  nearest_.bind({{0, &region_buffer}, {1, &near_block_buffer}});
  const std::uint32_t most_groups = device.properties().limits.maxComputeWorkGroupCount[0];
  const auto dispatch = [&](VkCommandBuffer commands, const ComputePipeline& pipeline, std::size_t first,
                            std::size_t last) {
    for (; first < last; first += most_groups) {
      constants.first = static_cast<std::uint32_t>(first);
      pipeline.dispatch(commands, std::as_bytes(std::span(&constants, 1)),
                        static_cast<std::uint32_t>(std::min<std::size_t>(last - first, most_groups)));
    }
    barrier(device, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT);
  };
  APPLIQUE_CHECK(device.run([&](VkCommandBuffer commands) {
    const VolkDeviceTable& vk = device.functions();
    vk.vkCmdFillBuffer(commands, region_buffer.handle(), 0, 4 * region_texels, 0);
    vk.vkCmdFillBuffer(commands, region_buffer.handle(), 4 * region_texels, VK_WHOLE_SIZE, shader::no_texel);
    barrier(device, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
    dispatch(commands, cover_, 0, foreign_first);
    dispatch(commands, cover_, foreign_first, plan.jobs.size());
    dispatch(commands, nearest_, 0, plan.nearest_blocks.size());
  }));
  for (std::size_t i = 0; i < run.decal.size(); ++i) {
    constants.piece_first = static_cast<std::uint32_t>(i * piece_texels);
    constants.piece_size = static_cast<std::uint32_t>(run.decal[i].size() / (4 * sizeof(std::uint16_t)));
    constants.piece_flags =
        (i > 0 ? shader::piece_follows : 0) | (i + 1 < run.decal.size() ? shader::piece_goes_on : 0);
    shade->bind(
        {{0, &region_buffer}, {1, &plan_buffer}, {2, &run.decal[i]}, {3, &work_buffer}, {4, &table_buffer}});
    APPLIQUE_CHECK(
        device.run([&](VkCommandBuffer commands) { dispatch(commands, *shade, 0, plan.blocks.size()); }));
  }

  APPLIQUE_CHECK(
      work_buffer.read(device, std::span(work_bytes).first(sizeof(WorkCounts) + 8 * work_layout.sums)));
  for (int y = 0; y < work.height; ++y)
    std::memcpy(run.texture.pixel(work.x, work.y + y), &texels[y * row], row);
  WorkCounts counts{};
  std::memcpy(&counts, work_bytes.data(), sizeof(counts));
  run.result.covered_texels += counts.covered;
  run.result.gutter_texels += counts.gutter;
  run.result.shared_texels += counts.shared;
  for (std::size_t i = 0; run.keep_samples && i < work_texels; ++i) {
    shader::vec2 sample;
    std::memcpy(&sample, &samples[i * sizeof(sample)], sizeof(sample));
    if (std::isnan(sample[0])) continue;
    run.result.samples.push_back({static_cast<std::uint32_t>(work.x + static_cast<int>(i % work.width)),
                                  static_cast<std::uint32_t>(work.y + static_cast<int>(i / work.width)),
                                  sheet,
                                  {sample[0], sample[1]}});
  }
  return {};
}

}  // namespace applique
