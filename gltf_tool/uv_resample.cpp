#include "uv_resample.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "applique/base/parallel.h"
#include "applique/image/decal_image.h"

#include "texel_map.h"
#include "uv_raster.h"

namespace applique {
namespace {

using Stored = std::array<std::uint16_t, 4>;
using Value = std::array<double, 4>;

constexpr int largest_stored = 65535;
constexpr double exact_hit = 1e-4;  // texels from a centre
constexpr int most_samples = 16;    // a side, within a texel

const std::vector<float>& linear_table() {
  static const std::vector<float> table = [] {
    std::vector<float> values(largest_stored + 1);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / largest_stored));
    return values;
  }();
  return table;
}

/// The old texture as its sampler shows it.
class Sampler {
 public:
  explicit Sampler(const Resampling& r) : r_(r), image_(*r.texture) {}

  /// The stored texel, if this is its centre.
  [[nodiscard]] std::optional<Stored> exactly(const Texel& at) const {
    const double x = r_.nearest ? std::floor(at[0]) : std::round(at[0] - 0.5);
    const double y = r_.nearest ? std::floor(at[1]) : std::round(at[1] - 0.5);
    if (!r_.nearest && !(std::abs(at[0] - 0.5 - x) < exact_hit && std::abs(at[1] - 0.5 - y) < exact_hit))
      return std::nullopt;
    const std::uint16_t* texel = texel_at(x, y);
    return Stored{texel[0], texel[1], texel[2], texel[3]};
  }

  [[nodiscard]] Value operator()(const Texel& at) const {
    if (const auto stored = exactly(at)) return value_of(stored->data());
    const double x = std::floor(at[0] - 0.5);
    const double y = std::floor(at[1] - 0.5);
    Value sum = {};
    const double right = at[0] - 0.5 - x;
    const double down = at[1] - 0.5 - y;
    for (int k = 0; k < 4; ++k) {
      const int column = k % 2, row = k / 2;
      const double weight = (column == 1 ? right : 1 - right) * (row == 1 ? down : 1 - down);
      const Value texel = value_of(texel_at(x + column, y + row));
      for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * texel[c];
    }
    return sum;
  }

  [[nodiscard]] Stored store(const Value& value) const {
    Stored stored = {};
    const double steps = r_.bits == 8 ? 255 : largest_stored;
    for (std::size_t c = 0; c < 4; ++c) {
      double x = std::clamp(value[c], 0.0, 1.0);
      if (c < 3 && r_.content == TexelContent::colour) x = linear_to_srgb(x);
      stored[c] = static_cast<std::uint16_t>(std::lround(x * steps) * std::lround(largest_stored / steps));
    }
    return stored;
  }

 private:
  [[nodiscard]] const std::uint16_t* texel_at(double x, double y) const {
    return image_.pixel(wrap_texel(static_cast<std::int64_t>(x), image_.width, r_.wrap_u),
                        wrap_texel(static_cast<std::int64_t>(y), image_.height, r_.wrap_v));
  }

  [[nodiscard]] Value value_of(const std::uint16_t* texel) const {
    Value value = {};
    for (std::size_t c = 0; c < 4; ++c)
      value[c] = c < 3 && r_.content == TexelContent::colour ? static_cast<double>(linear_table()[texel[c]])
                                                             : static_cast<double>(texel[c]) / largest_stored;
    return value;
  }

  const Resampling& r_;
  const Image& image_;
};

Stored mean_colour(const Image& image) {
  std::array<std::uint64_t, 4> sums = {};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) sums[i % 4] += image.rgba[i];
  Stored mean = {};
  const std::uint64_t pixels = image.rgba.size() / 4;
  for (std::size_t c = 0; c < 4; ++c) mean[c] = static_cast<std::uint16_t>(sums[c] / pixels / 257 * 257);
  return mean;
}

/// A chart in the new texture's texels: which triangle each texel shows, with the gutter round it.
class OwnerGrid {
 public:
  OwnerGrid(const AtlasChart& chart, const std::vector<std::array<Texel, 3>>& corners,
            const std::array<int, 4>& box, int gutter)
      : box_(box), owners_(static_cast<std::size_t>(box[2]) * static_cast<std::size_t>(box[3]), nobody) {
    std::vector<std::size_t> front;
    for (const std::uint32_t t : chart.triangles)
      for_each_texel(corners[t], [&](std::int64_t x, std::int64_t y) { own(x, y, t, front); });
    // Triangles between the centres have the texel under their middle, if nobody else has it.
    for (const std::uint32_t t : chart.triangles) {
      Texel middle = {};
      for (const Texel& corner : corners[t])
        for (std::size_t c = 0; c < 2; ++c) middle[c] += corner[c] / 3;
      own(static_cast<std::int64_t>(std::floor(middle[0])), static_cast<std::int64_t>(std::floor(middle[1])),
          t, front);
    }
    for (int ring = 0; ring < gutter && !front.empty(); ++ring) front = widen(front);
  }

  static constexpr std::uint32_t nobody = ~0U;
  [[nodiscard]] std::uint32_t at(int column, int row) const {
    return owners_[static_cast<std::size_t>(row) * static_cast<std::size_t>(box_[2]) +
                   static_cast<std::size_t>(column)];
  }

 private:
  void own(std::int64_t x, std::int64_t y, std::uint32_t triangle, std::vector<std::size_t>& front) {
    x -= box_[0];
    y -= box_[1];
    if (x < 0 || y < 0 || x >= box_[2] || y >= box_[3]) return;
    const std::size_t i =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(box_[2]) + static_cast<std::size_t>(x);
    if (owners_[i] != nobody) return;
    owners_[i] = triangle;
    front.push_back(i);
  }

  std::vector<std::size_t> widen(const std::vector<std::size_t>& front) {
    std::vector<std::size_t> next;
    const auto width = static_cast<std::size_t>(box_[2]);
    for (const std::size_t i : front) {
      const auto x = static_cast<std::int64_t>(i % width) + box_[0];
      const auto y = static_cast<std::int64_t>(i / width) + box_[1];
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) own(x + dx, y + dy, owners_[i], next);
    }
    return next;
  }

  std::array<int, 4> box_;
  std::vector<std::uint32_t> owners_;
};

/// Weights of a triangle's corners at the point of the triangle nearest to `at`.
std::array<double, 3> weights_near(const std::array<Texel, 3>& corners, const Texel& at) {
  std::array<double, 3> weights = {};
  const double area = doubled_area(corners);
  if (area != 0) {
    for (std::size_t k = 0; k < 3; ++k)
      weights[k] = doubled_area({at, corners[(k + 1) % 3], corners[(k + 2) % 3]}) / area;
    if (*std::min_element(weights.begin(), weights.end()) >= 0) return weights;
  }
  double nearest = HUGE_VAL;
  for (std::size_t k = 0; k < 3; ++k) {
    const Texel& a = corners[k];
    const Texel& b = corners[(k + 1) % 3];
    const Texel side = {b[0] - a[0], b[1] - a[1]};
    const double length = side[0] * side[0] + side[1] * side[1];
    const double along = length == 0 ? 0 : ((at[0] - a[0]) * side[0] + (at[1] - a[1]) * side[1]) / length;
    const double t = std::clamp(along, 0.0, 1.0);
    const double distance = std::hypot(a[0] + t * side[0] - at[0], a[1] + t * side[1] - at[1]);
    if (distance >= nearest) continue;
    nearest = distance;
    weights = {};
    weights[k] = 1 - t;
    weights[(k + 1) % 3] = t;
  }
  return weights;
}

/// Fills the charts of one texture.
class Filler {
 public:
  Filler(const Resampling& r, Image& out) : r_(r), sampler_(r), out_(out) {
    for (std::size_t c = 0; c < 2; ++c)
      texels_per_unit_[c] = static_cast<double>(r.size[c]) * r.layout->fineness / r.layout->size[c];
    corners_ = r.layout->corners;
    for (auto& corners : corners_)
      for (Texel& corner : corners)
        for (std::size_t c = 0; c < 2; ++c) corner[c] *= texels_per_unit_[c];
  }

  void fill(const AtlasChart& chart) {
    const std::array<int, 4> box = box_of(chart);
    if (chart.kept && r_.reference[0] > 0 && r_.turns.empty()) {
      copy(chart, box);
      return;
    }
    const double coarser = std::max(texels_per_unit_[0], texels_per_unit_[1]);
    const OwnerGrid owners(chart, corners_, box, static_cast<int>(std::ceil(r_.layout->gutter * coarser)));
    parallel_for(box[3], [&](int row) {
      for (int column = 0; column < box[2]; ++column) {
        const std::uint32_t owner = owners.at(column, row);
        if (owner == OwnerGrid::nobody) continue;
        show(owner, box[0] + column, box[1] + row);
      }
    });
  }

 private:
  [[nodiscard]] std::array<int, 4> box_of(const AtlasChart& chart) const {
    std::array<int, 4> box = {};
    for (std::size_t c = 0; c < 2; ++c) {
      const double first = chart.box[c] * texels_per_unit_[c];
      const double last = (chart.box[c] + chart.box[c + 2]) * texels_per_unit_[c];
      box[c] = static_cast<int>(std::floor(first + exact_hit));
      box[c + 2] = std::min(static_cast<int>(std::ceil(last - exact_hit)), r_.size[c]) - box[c];
    }
    return box;
  }

  /// The whole box is the old texture, moved.
  void copy(const AtlasChart& chart, const std::array<int, 4>& box) {
    TexelMap map;
    const double scale = r_.layout->scale;
    map.xx = 1 / (texels_per_unit_[0] * scale * r_.reference[0]);
    map.yy = 1 / (texels_per_unit_[1] * scale * r_.reference[1]);
    map.x0 = chart.shift[0] / (scale * r_.reference[0]);
    map.y0 = chart.shift[1] / (scale * r_.reference[1]);
    const int samples = samples_for(map);
    parallel_for(box[3], [&](int row) {
      for (int column = 0; column < box[2]; ++column) {
        const int x = box[0] + column;
        const int y = box[1] + row;
        if (samples == 1)
          if (const auto stored = sampler_.exactly(map({x + 0.5, y + 0.5}))) {
            std::copy(stored->begin(), stored->end(), out_.pixel(x, y));
            continue;
          }
        put(x, y, mean_over(x, y, samples, map));
      }
    });
  }

  void show(std::uint32_t triangle, int x, int y) {
    const auto& corners = corners_[triangle];
    const auto& old = r_.old_corners[triangle];
    const auto weights = weights_near(corners, {x + 0.5, y + 0.5});
    // In the gutter too, so that at the border filtering shows what it showed.
    const TexelMap map =
        doubled_area(corners) == 0 ? TexelMap{0, 0, 0, 0, old[0][0], old[0][1]} : map_between(corners, old);
    Value value = mean_over(x, y, samples_for(map), map);
    if (r_.content == TexelContent::normal && !r_.turns.empty()) turn(r_.turns[triangle], weights, value);
    put(x, y, value);
  }

  /// Turns x and y of a direction; its length across the surface stays.
  static void turn(const std::array<FrameTurn, 3>& turns, const std::array<double, 3>& weights,
                   Value& value) {
    const double x = 2 * value[0] - 1;
    const double y = 2 * value[1] - 1;
    double new_x = 0;
    double new_y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      new_x += weights[k] * (turns[k].xx * x + turns[k].xy * y);
      new_y += weights[k] * (turns[k].yx * x + turns[k].yy * y);
    }
    const double length = std::hypot(new_x, new_y);
    if (length == 0) return;
    const double scale = std::hypot(x, y) / length;
    value[0] = 0.5 + 0.5 * scale * new_x;
    value[1] = 0.5 + 0.5 * scale * new_y;
  }

  static int samples_for(const TexelMap& map) {
    return std::clamp(static_cast<int>(std::ceil(half_axes(map)[0] - 0.01)), 1, most_samples);
  }

  [[nodiscard]] Value mean_over(int x, int y, int samples, const TexelMap& map) const {
    if (samples == 1) return sampler_(map({x + 0.5, y + 0.5}));
    Value sum = {};
    for (int i = 0; i < samples * samples; ++i) {
      const int column = i % samples, row = i / samples;
      const Value value = sampler_(map({x + (column + 0.5) / samples, y + (row + 0.5) / samples}));
      for (std::size_t c = 0; c < 4; ++c) sum[c] += value[c] / (samples * samples);
    }
    return sum;
  }

  void put(int x, int y, const Value& value) {
    const Stored stored = sampler_.store(value);
    std::copy(stored.begin(), stored.end(), out_.pixel(x, y));
  }

  const Resampling& r_;
  Sampler sampler_;
  Image& out_;
  std::array<double, 2> texels_per_unit_ = {1, 1};
  std::vector<std::array<Texel, 3>> corners_;  ///< In the new texture's texels.
};

/// Looks for places where a texture would look otherwise in its new layout.
class Comparison {
 public:
  explicit Comparison(const Resampling& r) : r_(r), sampler_(r) {
    for (std::size_t c = 0; c < 2; ++c)
      texels_per_unit_[c] = static_cast<double>(r.size[c]) * r.layout->fineness / r.layout->size[c];
  }

  [[nodiscard]] bool finds_none() const {
    std::atomic<bool> same = true;
    const std::vector<std::array<Texel, 3>>& corners = r_.layout->corners;
    parallel_for(static_cast<int>(corners.size()), [&](int i) {
      const auto t = static_cast<std::size_t>(i);
      if (same && !interpolates(scaled(corners[t]), r_.old_corners[t])) same = false;
    });
    return same && edges_agree();
  }

 private:
  [[nodiscard]] std::array<Texel, 3> scaled(std::array<Texel, 3> corners) const {
    for (Texel& corner : corners)
      for (std::size_t c = 0; c < 2; ++c) corner[c] *= texels_per_unit_[c];
    return corners;
  }

  /// Where four texels meet, a sampler shows their mean.
  [[nodiscard]] bool interpolates(std::array<Texel, 3> corners, const std::array<Texel, 3>& old) const {
    if (doubled_area(corners) == 0) return true;
    const TexelMap map = map_between(corners, old);
    for (Texel& corner : corners)
      for (double& x : corner) x += 0.5;  // What is visited as a centre is where texels meet.
    bool same = true;
    for_each_texel(corners, [&](std::int64_t column, std::int64_t row) {
      if (!same || (column + row) % 2 != 0) return;  // Old texels are larger: every other place does.
      const auto x = static_cast<double>(column), y = static_cast<double>(row);
      Value mean = {};
      for (const auto& [dx, dy] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}}) {
        const Value value = sampler_(map({x + dx, y + dy}));
        for (std::size_t c = 0; c < 4; ++c) mean[c] += value[c] / 4;
      }
      same = look_alike(mean, sampler_(map({x, y})));
    });
    return same;
  }

  [[nodiscard]] bool edges_agree() const {
    struct Side {
      Texel first, last;  ///< In the old texture.
    };
    std::map<std::pair<Texel, Texel>, Side> sides;
    for (const AtlasChart& chart : r_.layout->charts)
      for (const std::uint32_t t : chart.triangles) {
        const std::array<Texel, 3> corners = scaled(r_.layout->corners[t]);
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t next = (k + 1) % 3;
          const Side side = {r_.old_corners[t][k], r_.old_corners[t][next]};
          const auto other = sides.find({corners[next], corners[k]});
          if (other == sides.end()) {
            sides[{corners[k], corners[next]}] = side;
            continue;
          }
          const Side& across = other->second;
          if (side.first == across.last && side.last == across.first) continue;
          const double length =
              std::hypot(corners[next][0] - corners[k][0], corners[next][1] - corners[k][1]);
          const int places = 1 + static_cast<int>(2 * length);
          for (int i = 0; i < places; ++i) {
            const double s = (i + 0.5) / places;
            if (!look_alike(sampler_(between(side.first, side.last, s)),
                            sampler_(between(across.last, across.first, s))))
              return false;
          }
        }
      }
    return true;
  }

  static Texel between(const Texel& a, const Texel& b, double s) {
    return {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])};
  }

  [[nodiscard]] bool look_alike(const Value& a, const Value& b) const {
    constexpr double most = 2.0 / 255;
    constexpr double steepest = 12.92;  // linear_to_srgb
    for (std::size_t c = 0; c < 4; ++c) {
      if (steepest * std::abs(a[c] - b[c]) <= most) continue;
      const bool encoded = c < 3 && r_.content == TexelContent::colour;
      if (std::abs(encoded ? linear_to_srgb(a[c]) - linear_to_srgb(b[c]) : a[c] - b[c]) > most) return false;
    }
    return true;
  }

  const Resampling& r_;
  Sampler sampler_;
  std::array<double, 2> texels_per_unit_ = {1, 1};
};

/// The size at which a layout loses no detail of a texture that it did not start from.
std::array<int, 2> resampled_size(const Resampling& resampling) {
  constexpr double largest = 8192;
  const UvLayout& layout = *resampling.layout;
  std::array<double, 2> density = {1, 1};  // texels by texel of the base colour
  if (resampling.reference[0] > 0) {
    for (std::size_t c = 0; c < 2; ++c) density[c] = 1 / (resampling.reference[c] * layout.scale);
  } else {
    constexpr double most = 8;
    density.fill(
        std::clamp(usual_stretch(layout.corners, resampling.old_corners) / layout.fineness, 1 / most, most));
  }
  std::array<int, 2> size = {};
  for (std::size_t c = 0; c < 2; ++c)
    size[c] = static_cast<int>(std::clamp(std::round(layout.size[c] * density[c]), 1.0, largest));
  return size;
}

}  // namespace

bool keeps_look(const Resampling& resampling) {
  return Comparison(resampling).finds_none();
}

Resampling plan_resampling(const Document& document, const TextureSlots& slots, const Image& image,
                           std::vector<std::array<Texel, 3>> old_corners, const UvLayout& layout,
                           const std::array<int, 2>& started_from, const UvMapping& base) {
  Resampling resampling;
  resampling.texture = &image;
  resampling.old_corners = std::move(old_corners);
  resampling.layout = &layout;
  const auto& texture = document.json["textures"][slots.texture];
  const auto [wrap_u, wrap_v] = read_wrap_modes(document, texture);
  resampling.wrap_u = wrap_u;
  resampling.wrap_v = wrap_v;
  resampling.nearest = magnifies_nearest(document, texture);
  resampling.content = slots.content;
  resampling.bits = image.bits;
  if (slots.mapping == base)
    resampling.reference = {static_cast<double>(started_from[0]) / image.width,
                            static_cast<double>(started_from[1]) / image.height};
  resampling.size = slots.name == "baseColorTexture" ? layout.size : resampled_size(resampling);
  return resampling;
}

Image resample_texture(const Resampling& resampling) {
  Image out = make_image(resampling.size[0], resampling.size[1], mean_colour(*resampling.texture));
  out.channels = resampling.texture->channels;
  out.bits = resampling.bits;
  Filler filler(resampling, out);
  for (const AtlasChart& chart : resampling.layout->charts) filler.fill(chart);
  return out;
}

}  // namespace applique
