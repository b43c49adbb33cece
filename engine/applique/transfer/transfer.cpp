#include "applique/transfer/transfer.h"

#include <algorithm>
#include <cmath>

#include "applique/base/parallel.h"
#include "applique/transfer/divide.h"
#include "applique/transfer/raster.h"
#include "applique/transfer/refine.h"

#include "compositing.h"

namespace applique {
namespace {

using Colour = std::array<double, 4>;  // Linear light.

double clamp01(double value) {
  return std::clamp(value, 0.0, 1.0);
}

// Whose texel each one of the region is, and the nearest owned texel along its row.
struct Ownership {
  TexelRect region;
  std::vector<std::uint32_t> owner;
  std::vector<std::int16_t> nearest;
};
constexpr std::int16_t none_near = 0x7fff;

void cover(const std::vector<shader::RasterJob>& jobs, Ownership& ownership) {
  constexpr int block = shader::block_size;
  for (const shader::RasterJob& job : jobs) {
    const int x0 = static_cast<int>(job.x), y0 = static_cast<int>(job.y);
    for (int y = 0; y < std::min(block, ownership.region.height - y0); ++y) {
      for (int x = 0; x < std::min(block, ownership.region.width - x0); ++x) {
        bool inside = true;
        for (int k = 0; k < 3; ++k) inside &= job.a[k] * x + job.b[k] * y + job.c[k] >= 0;
        if (!inside) continue;
        std::uint32_t& owner =
            ownership.owner[static_cast<std::size_t>(y0 + y) * ownership.region.width + x0 + x];
        if (job.key == shader::copy_key)
          owner |= (owner & shader::key_mask) != 0 ? shader::foreign_bit : 0;
        else
          owner = (job.key & shader::key_mask) == 0 ? owner | job.key : std::max(owner, job.key);
      }
    }
  }
}

void find_nearest_in_row(int y, int gutter, Ownership& ownership) {
  const std::size_t row = static_cast<std::size_t>(y) * ownership.region.width;
  for (int x = 0; x < ownership.region.width; ++x) {
    std::int16_t& nearest = ownership.nearest[row + x];
    nearest = none_near;
    for (int i = 0; i <= 2 * gutter; ++i) {
      const int dx = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
      if (x + dx < 0 || x + dx >= ownership.region.width || ownership.owner[row + x + dx] == 0) continue;
      nearest = static_cast<std::int16_t>(dx);
      break;
    }
  }
}

// The nearest owned texel within the gutter: rows nearest first, the upper one of two.
std::array<int, 2> find_nearest(int x, int y, int gutter, const Ownership& ownership) {
  int best = gutter * gutter + 1;
  std::array<int, 2> seed = {x, y};
  for (int i = 0; i <= 2 * gutter; ++i) {
    const int dy = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
    if (dy * dy >= best) break;
    if (y + dy < 0 || y + dy >= ownership.region.height) continue;
    const int dx = ownership.nearest[static_cast<std::size_t>(y + dy) * ownership.region.width + x];
    if (dx == none_near || dx * dx + dy * dy >= best) continue;
    best = dx * dx + dy * dy;
    seed = {x + dx, y + dy};
  }
  return seed;
}

Colour fetch(const DecalImage& image, std::size_t level, double x, double y) {
  const DecalImage::Level& stored = image.levels[level];
  if (x < 0 || y < 0 || x >= stored.width || y >= stored.height) return {};
  const auto& texel =
      image.texels[stored.offset + static_cast<std::size_t>(y) * stored.width + static_cast<std::size_t>(x)];
  return {texel[0], texel[1], texel[2], texel[3]};
}

void add_bilinear(const DecalImage& image, std::size_t level, Pixel pixel, double weight, Colour& sum) {
  const double scale = std::ldexp(1.0, -static_cast<int>(level));
  const double x = pixel.x * scale - 0.5, y = pixel.y * scale - 0.5;
  const double x0 = std::floor(x), y0 = std::floor(y);
  for (int k = 0; k < 4; ++k) {
    const int dx = k % 2, dy = k / 2;
    const double wx = dx == 1 ? x - x0 : x0 + 1 - x, wy = dy == 1 ? y - y0 : y0 + 1 - y;
    const Colour texel = fetch(image, level, x0 + dx, y0 + dy);
    for (int c = 0; c < 4; ++c) sum[c] += weight * wx * wy * texel[c];
  }
}

Colour sample_decal(const DecalImage& image, Pixel pixel, const Footprint& footprint) {
  const auto [columns, rows] = footprint.probes;
  Colour sum{};
  for (int row = 0; row < rows; ++row) {
    const double y = (row + 0.5) / rows - 0.5;
    for (int column = 0; column < columns; ++column) {
      const double x = (column + 0.5) / columns - 0.5;
      add_bilinear(image, static_cast<std::size_t>(footprint.level),
                   {pixel.x + x * footprint.along_x[0] + y * footprint.along_y[0],
                    pixel.y + x * footprint.along_x[1] + y * footprint.along_y[1]},
                   1.0 / (columns * rows), sum);
    }
  }
  return sum;
}

// The texel's own encoding.
compositing::vec4 composite(const Colour& source, const compositing::vec4& below, const Transfer& transfer,
                            Vec2 along, bool reversed) {
  const auto mode = static_cast<std::uint32_t>(transfer.blend);
  const compositing::vec4 over(source[0], source[1], source[2], source[3]);
  if (transfer.encoding == Encoding::normal) {
    const Vec2 x = along == Vec2(0) ? Vec2(1) : along / std::abs(along);
    const Vec2 y = Vec2(0, reversed ? -1 : 1) * x;
    return compositing::composite_normal(mode, over, below, {x.real(), x.imag()}, {y.real(), y.imag()});
  }
  if (transfer.encoding == Encoding::data) return compositing::composite(mode, over, below, true);
  compositing::vec4 linear = below;
  for (int c = 0; c < 3; ++c) linear[c] = srgb_to_linear(below[c]);
  compositing::vec4 result = compositing::composite(mode, over, linear, transfer.opaque);
  for (int c = 0; c < 3; ++c) result[c] = linear_to_srgb(clamp01(result[c]));
  return result;
}

void blend_over(std::uint16_t* texel, const Colour& source, const Transfer& transfer, Vec2 along,
                bool reversed, int bits) {
  compositing::vec4 below;
  for (int c = 0; c < 4; ++c) below[c] = texel[c] / 65535.0;
  const compositing::vec4 result = composite(source, below, transfer, along, reversed);
  const double steps = bits == 8 ? 255 : 65535;
  for (int c = 0; c < 4; ++c)
    if (transfer.channels[static_cast<std::size_t>(c)])
      texel[c] = static_cast<std::uint16_t>(std::floor(clamp01(result[c]) * steps + 0.5) * (65535 / steps));
}

// `shown` and `refined` by face. Adds to `total`.
void composite_sheet(const Transfer& transfer, std::uint32_t sheet,
                     std::span<const std::optional<TexelBounds>> shown,
                     const std::vector<RefinedFace>& refined, int bits, bool keep_samples, Image& texture,
                     TransferResult& total) {
  const TilePlan plan =
      plan_tile(transfer, shown, texture.width, texture.height, {0, 0, texture.width, texture.height}, sheet);
  const int gutter = static_cast<int>(std::min(transfer.gutter, 255u));
  const TexelRect &work = plan.work, &region = plan.region;

  Ownership ownership{region, {}, {}};
  ownership.owner.resize(static_cast<std::size_t>(region.width) * region.height);
  ownership.nearest.resize(ownership.owner.size());
  cover(plan.jobs, ownership);
  cover(plan.foreign_jobs, ownership);
  parallel_for(region.height, [&](int y) { find_nearest_in_row(y, gutter, ownership); });

  std::vector<PlacedFace> faces;
  faces.reserve(plan.placements.size());
  for (const Placement& placement : plan.placements) {
    faces.push_back(place_face(transfer, placement, refined[placement.face].cells));
  }

  std::vector<TransferResult> rows(static_cast<std::size_t>(work.height));
  parallel_for(work.height, [&](int row) {
    TransferResult& result = rows[row];
    const int y = row + work.y - region.y;
    for (int column = 0; column < work.width; ++column) {
      const int x = column + work.x - region.x;
      std::uint32_t owner = ownership.owner[static_cast<std::size_t>(y) * region.width + x];
      const bool outside = owner == 0;
      std::array<int, 2> seed = {x, y};
      if (outside) {
        seed = find_nearest(x, y, gutter, ownership);
        owner = ownership.owner[static_cast<std::size_t>(seed[1]) * region.width + seed[0]];
      }
      const std::uint32_t key = owner & shader::key_mask;
      if (key == 0) continue;
      (outside ? result.gutter_texels : result.covered_texels) += 1;
      if (!outside && (owner & shader::foreign_bit) != 0) ++result.shared_texels;

      const PlacedFace& face = faces[key - 1];
      const auto place = face.clamped ? face.map.at(seed[0], seed[1]) : face.map.at(x, y);
      const std::uint32_t index = plan.placements[key - 1].face;
      Pixel pixel = {place[0], place[1]};
      if (refined[index].cells > 0)
        pixel = refined[index].at(place[0], place[1]);
      else if (face.warped && transfer.warp->groups > 1)
        pixel = warp_in_face(transfer, index, place[0], place[1]);
      else if (face.warped)
        pixel = transfer.image->frame.to_pixel((*transfer.warp)({place[0], place[1]}));
      if (keep_samples && !outside) {
        result.samples.push_back({static_cast<std::uint32_t>(column + work.x),
                                  static_cast<std::uint32_t>(row + work.y), sheet, pixel});
      }
      Colour source = sample_decal(*transfer.image, pixel, face.footprint);
      for (double& channel : source) channel *= transfer.opacity;
      if (source[3] <= 0) continue;
      const auto along = face.clamped ? face.along.at(seed[0], seed[1]) : face.along.at(x, y);
      blend_over(texture.pixel(column + work.x, row + work.y), source, transfer, {along[0], along[1]},
                 transfer.faces[index].reversed, bits);
    }
  });

  for (const TransferResult& row : rows) {
    total.covered_texels += row.covered_texels;
    total.gutter_texels += row.gutter_texels;
    total.shared_texels += row.shared_texels;
    total.samples.insert(total.samples.end(), row.samples.begin(), row.samples.end());
  }
}

}  // namespace

TransferResult transfer_on_cpu(const Transfer& transfer, Image& texture, bool keep_samples) {
  if (const auto divided = divide_faces(transfer)) return transfer_on_cpu(*divided, texture, keep_samples);
  const auto shown = shown_parts(transfer);
  const std::vector<RefinedFace> refined = refine_faces(transfer, shown);
  const std::vector<std::uint32_t> sheets = sheets_of(transfer);
  const int bits = working_bits(texture, sheets.size());
  TransferResult result;
  for (const std::uint32_t sheet : sheets)
    composite_sheet(transfer, sheet, shown, refined, bits, keep_samples, texture, result);
  if (bits != texture.bits) round_to_8_bits(texture);
  if (texture.channels < 3 && result.covered_texels + result.gutter_texels > 0) texture.channels += 2;
  return result;
}

}  // namespace applique
