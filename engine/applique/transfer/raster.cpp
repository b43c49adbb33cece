#include "applique/transfer/raster.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "applique/base/convex_clip.h"

namespace applique {
namespace {

using FixedCorners = std::array<std::array<std::int64_t, 2>, 3>;

constexpr std::int64_t subtexels = 256;
constexpr int block = shader::block_size;
constexpr double max_extent = 131072;  // Texels; keeps edge functions within 32 bits over a block.
constexpr int max_periods = 64;

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

// One copy of the plane along one axis: texel t of the plane is seen at sign * t + shift.
struct AxisCopy {
  int sign;
  std::int64_t shift;  // Texels.
};

// The copies by which [lower, upper] is seen in [first, last), all in texels: a range of periods.
struct AxisCopies {
  WrapMode mode;
  int size;
  std::int64_t low = 0, high = 0;  // low > high: none.

  AxisCopies(WrapMode wrap, int period, double lower, double upper, int first, int last)
      : mode(wrap), size(period) {
    if (mode == WrapMode::clamp) return;
    const double from =
        mode == WrapMode::repeat ? std::floor((first - upper) / size) : std::floor(lower / size);
    const double to = mode == WrapMode::repeat ? std::ceil((last - lower) / size) : std::floor(upper / size);
    const bool few = to - from <= max_periods;
    low = few ? static_cast<std::int64_t>(from) : 1;
    high = few ? static_cast<std::int64_t>(to) : 0;
  }

  // Calls `visit(copy)` for each, in the order of the plane.
  template <class Visit>
  void each(Visit visit) const {
    for (std::int64_t i = low; i <= high; ++i) {
      const std::int64_t k = mode == WrapMode::repeat ? high - (i - low) : i;
      if (mode == WrapMode::mirror && k % 2 != 0)
        visit(AxisCopy{-1, (k + 1) * size});
      else
        visit(AxisCopy{1, mode == WrapMode::mirror ? -k * size : k * size});
    }
  }
};

std::optional<TexelBounds> bounds_of(const std::array<Texel, 3>& corners) {
  TexelBounds bounds{};
  for (int axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    if (!(high - low <= max_extent) || !(std::abs(low) < 1e9)) return std::nullopt;
    bounds.lower[axis] = low;
    bounds.upper[axis] = high;
  }
  return bounds;
}

// Calls `visit(x, y, bounds)` for every copy of a part of the plane that touches `window`, a rectangle of it.
template <class Visit>
void for_each_copy(const Transfer& transfer, const std::optional<TexelBounds>& bounds, int width, int height,
                   const TexelRect& window, Visit visit) {
  if (!bounds) return;
  const AxisCopies copies_x(transfer.wrap_u, width, bounds->lower[0], bounds->upper[0], window.x,
                            window.x + window.width);
  const AxisCopies copies_y(transfer.wrap_v, height, bounds->lower[1], bounds->upper[1], window.y,
                            window.y + window.height);
  copies_y.each([&](const AxisCopy& y) {
    const double y0 =
        y.sign * (y.sign > 0 ? bounds->lower[1] : bounds->upper[1]) + static_cast<double>(y.shift);
    const double y1 = y0 + bounds->upper[1] - bounds->lower[1];
    if (y1 < window.y || y0 > window.y + window.height) return;
    copies_x.each([&](const AxisCopy& x) {
      const double x0 =
          x.sign * (x.sign > 0 ? bounds->lower[0] : bounds->upper[0]) + static_cast<double>(x.shift);
      const double x1 = x0 + bounds->upper[0] - bounds->lower[0];
      if (x1 < window.x || x0 > window.x + window.width) return;
      visit(x, y, TexelBounds{{x0, y0}, {x1, y1}});
    });
  });
}

FixedCorners fixed_corners(const std::array<Texel, 3>& corners, const AxisCopy& x, const AxisCopy& y) {
  FixedCorners fixed;
  for (int k = 0; k < 3; ++k) {
    fixed[k][0] = x.sign * std::llround(corners[k][0] * subtexels) + x.shift * subtexels;
    fixed[k][1] = y.sign * std::llround(corners[k][1] * subtexels) + y.shift * subtexels;
  }
  return fixed;
}

std::array<Texel, 3> moved_corners(const std::array<Texel, 3>& corners, const AxisCopy& x,
                                   const AxisCopy& y) {
  std::array<Texel, 3> moved;
  for (int k = 0; k < 3; ++k) {
    moved[k] = {x.sign * corners[k][0] + static_cast<double>(x.shift),
                y.sign * corners[k][1] + static_cast<double>(y.shift)};
  }
  return moved;
}

// Which blocks of a region, one byte each.
struct BlockMask {
  int width, height;
  std::vector<std::uint8_t> set;

  explicit BlockMask(const TexelRect& region)
      : width((region.width + block - 1) / block),
        height((region.height + block - 1) / block),
        set(static_cast<std::size_t>(width) * height) {}

  [[nodiscard]] BlockMask dilated(int by_x, int by_y) const {
    BlockMask rows = *this, result = *this;
    std::fill(rows.set.begin(), rows.set.end(), std::uint8_t{0});
    std::fill(result.set.begin(), result.set.end(), std::uint8_t{0});
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!set[static_cast<std::size_t>(y) * width + x]) continue;
        auto row = rows.set.begin() + static_cast<std::ptrdiff_t>(y) * width;
        std::fill(row + std::max(0, x - by_x), row + std::min(width, x + by_x + 1), std::uint8_t{1});
      }
    }
    for (int y = 0; y < height; ++y) {
      for (int near = std::max(0, y - by_y); near <= std::min(height - 1, y + by_y); ++near) {
        for (int x = 0; x < width; ++x) {
          result.set[static_cast<std::size_t>(y) * width + x] |=
              rows.set[static_cast<std::size_t>(near) * width + x];
        }
      }
    }
    return result;
  }
  [[nodiscard]] std::vector<std::uint32_t> list() const {
    std::vector<std::uint32_t> blocks;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (set[static_cast<std::size_t>(y) * width + x]) {
          blocks.push_back(static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 16);
        }
      }
    }
    return blocks;
  }
};

// Jobs for the blocks of the region that a triangle (plane coordinates) touches, of those that meet `within`.
// `allowed` limits the blocks.
void add_jobs(FixedCorners corners, const TexelBounds& within, std::uint32_t key, const TexelRect& region,
              const BlockMask* allowed, std::vector<shader::RasterJob>& jobs) {
  const auto edge_area = [](const auto& p, const auto& q, const auto& r) {
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  };
  const std::int64_t area = edge_area(corners[0], corners[1], corners[2]);
  if (area == 0) return;
  if (area < 0) std::swap(corners[1], corners[2]);

  std::int64_t first[2], last[2];  // Blocks.
  const std::int64_t origin[2] = {region.x, region.y}, size[2] = {region.width, region.height};
  for (int axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    const auto lower = static_cast<std::int64_t>(std::floor(within.lower[axis]));
    const auto upper = static_cast<std::int64_t>(std::ceil(within.upper[axis]));
    const std::int64_t low_texel = std::max(floor_divide(low, subtexels), lower) - origin[axis];
    const std::int64_t high_texel = std::min(floor_divide(high, subtexels), upper) - origin[axis];
    if (high_texel < 0 || low_texel >= size[axis] || high_texel < low_texel) return;
    first[axis] = std::max<std::int64_t>(low_texel, 0) / block;
    last[axis] = std::min(high_texel, size[axis] - 1) / block;
  }

  std::int64_t a[3], b[3],
      start[3];  // start: 1/256 of the edge function at the region's first texel, but exact.
  for (int k = 0; k < 3; ++k) {
    const auto &p = corners[k], &q = corners[(k + 1) % 3];
    const std::int64_t dx = q[0] - p[0], dy = q[1] - p[1];
    a[k] = -dy;
    b[k] = dx;
    const std::int64_t x = origin[0] * subtexels + subtexels / 2, y = origin[1] * subtexels + subtexels / 2;
    const bool owns_edge = dy > 0 || (dy == 0 && dx < 0);
    start[k] = floor_divide(dx * (y - p[1]) - dy * (x - p[0]) - (owns_edge ? 0 : 1), subtexels);
  }
  // Within a block the edge function changes by less than this, so clamping beyond it keeps all signs.
  constexpr std::int64_t far = std::int64_t{1} << 30;
  for (std::int64_t by = first[1]; by <= last[1]; ++by) {
    for (std::int64_t bx = first[0]; bx <= last[0]; ++bx) {
      if (allowed && !allowed->set[static_cast<std::size_t>(by) * allowed->width + bx]) continue;
      shader::RasterJob job{};
      bool outside = false;
      for (int k = 0; k < 3; ++k) {
        const std::int64_t c = start[k] + block * (a[k] * bx + b[k] * by);
        outside |= c + (block - 1) * (std::max<std::int64_t>(a[k], 0) + std::max<std::int64_t>(b[k], 0)) < 0;
        job.a[k] = static_cast<std::int32_t>(a[k]);
        job.b[k] = static_cast<std::int32_t>(b[k]);
        job.c[k] = static_cast<std::int32_t>(std::clamp(c, -far, far));
      }
      if (outside) continue;
      job.key = key;
      job.x = static_cast<std::uint32_t>(bx * block);
      job.y = static_cast<std::uint32_t>(by * block);
      jobs.push_back(job);
    }
  }
}

std::array<Texel, 3> rounded(std::array<Texel, 3> corners) {
  for (Texel& corner : corners) {
    for (double& value : corner) value = static_cast<double>(std::llround(value * subtexels)) / subtexels;
  }
  return corners;
}

AffineMap affine_map(const std::array<Texel, 3>& corners,
                     const std::array<std::array<double, 2>, 3>& values) {
  AffineMap map{};
  const double area = doubled_area(corners);
  const double ux = corners[1][0] - corners[0][0], uy = corners[1][1] - corners[0][1];
  const double vx = corners[2][0] - corners[0][0], vy = corners[2][1] - corners[0][1];
  for (int axis = 0; axis < 2; ++axis) {
    map.origin[axis] =
        static_cast<int>(std::floor((corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3));
  }
  const double x = map.origin[0] + 0.5 - corners[0][0], y = map.origin[1] + 0.5 - corners[0][1];
  for (int i = 0; i < 2; ++i) {
    const double du = values[1][i] - values[0][i], dv = values[2][i] - values[0][i];
    map.dx[i] = (du * vy - dv * uy) / area;
    map.dy[i] = (dv * ux - du * vx) / area;
    map.value[i] = values[0][i] + map.dx[i] * x + map.dy[i] * y;
  }
  return map;
}

// Whether texels are pixels: then the image is copied, not filtered.
bool is_unscaled(const AffineMap& map) {
  constexpr double tolerance = 1e-3;
  const double across = map.dx[0] * map.dy[0] + map.dx[1] * map.dy[1];
  return std::abs(std::hypot(map.dx[0], map.dx[1]) - 1) < tolerance &&
         std::abs(std::hypot(map.dy[0], map.dy[1]) - 1) < tolerance && std::abs(across) < tolerance;
}

Footprint footprint_of(const AffineMap& map, std::size_t levels) {
  constexpr double probes_a_pixel = 2, most_short = 8, most_long = 32;
  Footprint footprint;
  if (is_unscaled(map)) return footprint;
  footprint.along_x = {map.dx[0], map.dx[1]};
  footprint.along_y = {map.dy[0], map.dy[1]};
  const std::array<double, 2> sides = {std::hypot(map.dx[0], map.dx[1]), std::hypot(map.dy[0], map.dy[1])};
  const auto [shorter, longer] = std::minmax(sides[0], sides[1]);
  const double coarsest =
      std::max(probes_a_pixel * shorter / most_short, probes_a_pixel * longer / most_long);
  footprint.level = static_cast<int>(
      std::clamp(std::ceil(std::log2(std::max(coarsest, 1.0))), 0.0, static_cast<double>(levels - 1)));
  for (std::size_t k = 0; k < 2; ++k)
    footprint.probes[k] = static_cast<int>(
        std::clamp(std::ceil(probes_a_pixel * std::ldexp(sides[k], -footprint.level)), 1.0, most_long));
  return footprint;
}

// A place of a face, in the texture and in the image or the plane.
struct FacePlace {
  Texel texel;
  std::array<double, 2> at;
};

// The part of a convex polygon where sign * at[axis] <= limit.
std::vector<FacePlace> clip(const std::vector<FacePlace>& polygon, std::size_t axis, double sign,
                            double limit) {
  return clip_convex(
      polygon, [&](const FacePlace& place) { return limit - sign * place.at[axis]; },
      [](const FacePlace& from, const FacePlace& to, double t) {
        FacePlace place;
        for (std::size_t c = 0; c < 2; ++c) {
          place.texel[c] = from.texel[c] + t * (to.texel[c] - from.texel[c]);
          place.at[c] = from.at[c] + t * (to.at[c] - from.at[c]);
        }
        return place;
      });
}

// A rectangle of the image (pixels) or of the plane.
struct Box {
  std::array<double, 2> lower = {HUGE_VAL, HUGE_VAL}, upper = {-HUGE_VAL, -HUGE_VAL};

  void add(const std::array<double, 2>& at) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      lower[axis] = std::min(lower[axis], at[axis]);
      upper[axis] = std::max(upper[axis], at[axis]);
    }
  }
  [[nodiscard]] Box grown(const std::array<double, 2>& by) const {
    return {{lower[0] - by[0], lower[1] - by[1]}, {upper[0] + by[0], upper[1] + by[1]}};
  }
};

// Finds the parts of faces that show the image: small decals lie in large triangles.
class ShownParts {
 public:
  explicit ShownParts(const Transfer& transfer) : transfer_(transfer) {}

  // The part of a large face whose texels, or those that extend it in the gutter, may show some of the image.
  // None: no such part. Small faces count as a whole, and those of a warp with groups.
  std::optional<TexelBounds> part_of(const TransferFace& face) {
    constexpr double large = 128;  // Texels a side.
    const std::optional<TexelBounds> whole = bounds_of(face.texel);
    const bool warped = !face.linear && transfer_.warp != nullptr && transfer_.warp->steps > 0;
    if (!whole || doubled_area(face.texel) == 0 || (warped && transfer_.warp->groups > 1)) return whole;
    if (whole->upper[0] - whole->lower[0] < large && whole->upper[1] - whole->lower[1] < large) return whole;
    const ImageFrame& frame = transfer_.image->frame;
    std::array<std::array<double, 2>, 3> pixels, places;
    for (std::size_t k = 0; k < 3; ++k) {
      const Pixel pixel = frame.to_pixel(face.image[k]);
      pixels[k] = {pixel.x, pixel.y};
      places[k] = warped ? std::array{face.plane[k].real(), face.plane[k].imag()} : pixels[k];
    }
    const AffineMap map = affine_map(face.texel, pixels);
    // What a texel's footprint and the filter of its level reach.
    const double filter = std::ldexp(2.0, footprint_of(map, transfer_.image->levels.size()).level);
    const std::array<double, 2> margin = {std::abs(map.dx[0]) + std::abs(map.dy[0]) + filter,
                                          std::abs(map.dx[1]) + std::abs(map.dy[1]) + filter};
    if (!std::isfinite(margin[0]) || !std::isfinite(margin[1])) return whole;
    const Box image = Box{{0, 0}, {double(frame.width), double(frame.height)}}.grown(margin);
    const Box box = warped ? in_plane(std::max(margin[0], margin[1])) : image;
    std::vector<FacePlace> polygon;
    for (std::size_t k = 0; k < 3; ++k) polygon.push_back({face.texel[k], places[k]});
    for (std::size_t axis = 0; axis < 2; ++axis) {
      polygon = clip(polygon, axis, 1, box.upper[axis]);
      polygon = clip(polygon, axis, -1, -box.lower[axis]);
    }
    if (polygon.empty()) return std::nullopt;
    const double reach = std::min(transfer_.gutter, 255u) + 2.0;
    Box texels;
    for (const FacePlace& place : polygon) texels.add(place.texel);
    texels = texels.grown({reach, reach});
    TexelBounds shown = *whole;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      shown.lower[axis] = std::max(shown.lower[axis], texels.lower[axis]);
      shown.upper[axis] = std::min(shown.upper[axis], texels.upper[axis]);
    }
    return shown;
  }

 private:
  // A box of the plane outside which the warp takes as good as nothing to within `margin` pixels of the
  // image: about the places that it takes to the rim, and somewhat more, for what bends between these. A flow
  // takes the inside of the one to the inside of the other.
  const Box& in_plane(double margin) {
    constexpr int parts = 64;                          // Of a side.
    constexpr double more = 0.5;                       // Of the box's size.
    margin = std::exp2(std::ceil(std::log2(margin)));  // So that there are few.
    const auto [known, is_new] = in_plane_.try_emplace(margin);
    if (!is_new) return known->second;
    const ImageFrame& frame = transfer_.image->frame;
    const double width = frame.width + 2 * margin, height = frame.height + 2 * margin;
    Box rim;
    for (int i = 0; i < parts; ++i) {
      const double x = width * i / parts - margin, y = height * i / parts - margin;
      for (const Pixel pixel :
           {Pixel{x, -margin}, Pixel{frame.width + margin, y}, Pixel{frame.width - x, frame.height + margin},
            Pixel{-margin, frame.height - y}}) {
        const Vec2 z = transfer_.warp->backward(frame.to_plane(pixel));
        rim.add({z.real(), z.imag()});
      }
    }
    known->second = rim.grown({more * (rim.upper[0] - rim.lower[0]), more * (rim.upper[1] - rim.lower[1])});
    return known->second;
  }

  const Transfer& transfer_;
  std::map<double, Box> in_plane_;  ///< By margin.
};

// Whether there is more of a face than its part.
bool is_clipped(const TransferFace& face, const std::optional<TexelBounds>& part) {
  const std::optional<TexelBounds> whole = bounds_of(face.texel);
  return whole && (!part || part->lower != whole->lower || part->upper != whole->upper);
}

}  // namespace

std::vector<std::uint32_t> sheets_of(const Transfer& transfer) {
  std::set<std::uint32_t> sheets;
  for (const TransferFace& face : transfer.faces) sheets.insert(face.sheet);
  return {sheets.begin(), sheets.end()};
}

std::vector<std::optional<TexelBounds>> shown_parts(const Transfer& transfer) {
  ShownParts parts(transfer);
  std::vector<std::optional<TexelBounds>> shown;
  for (const TransferFace& face : transfer.faces) shown.push_back(parts.part_of(face));
  return shown;
}

TilePlan plan_tile(const Transfer& transfer, std::span<const std::optional<TexelBounds>> shown, int width,
                   int height, const TexelRect& tile, std::uint32_t sheet) {
  const int gutter = static_cast<int>(std::min(transfer.gutter, 255u));
  TilePlan plan;

  // The region of a rectangle: its margin may cross the border where the axis repeats.
  const auto with_margin = [&](const TexelRect& r) {
    int x0 = r.x - gutter, y0 = r.y - gutter, x1 = r.x + r.width + gutter, y1 = r.y + r.height + gutter;
    if (transfer.wrap_u != WrapMode::repeat) x0 = std::max(x0, 0), x1 = std::min(x1, width);
    if (transfer.wrap_v != WrapMode::repeat) y0 = std::max(y0, 0), y1 = std::min(y1, height);
    return TexelRect{x0, y0, x1 - x0, y1 - y0};
  };

  struct Shape {
    FixedCorners corners;
    TexelBounds shown;
  };
  std::vector<Shape> shapes;  // By placement.
  const TexelRect window = with_margin(tile);
  int x0 = tile.x + tile.width, y0 = tile.y + tile.height, x1 = tile.x, y1 = tile.y;
  for (std::uint32_t face = 0; face < transfer.faces.size(); ++face) {
    if (transfer.faces[face].sheet != sheet) continue;
    const auto& corners = transfer.faces[face].texel;
    for_each_copy(transfer, shown[face], width, height, window,
                  [&](const AxisCopy& x, const AxisCopy& y, const TexelBounds& bounds) {
                    plan.placements.push_back({face, moved_corners(corners, x, y)});
                    shapes.push_back({fixed_corners(corners, x, y), bounds});
                    x0 = std::min(x0, static_cast<int>(std::floor(bounds.lower[0])) - gutter - 1);
                    y0 = std::min(y0, static_cast<int>(std::floor(bounds.lower[1])) - gutter - 1);
                    x1 = std::max(x1, static_cast<int>(std::ceil(bounds.upper[0])) + gutter + 1);
                    y1 = std::max(y1, static_cast<int>(std::ceil(bounds.upper[1])) + gutter + 1);
                  });
  }
  x0 = std::max(x0, tile.x), y0 = std::max(y0, tile.y);
  x1 = std::min(x1, tile.x + tile.width), y1 = std::min(y1, tile.y + tile.height);
  if (plan.placements.empty() || x1 <= x0 || y1 <= y0) return {};
  plan.work = {x0, y0, x1 - x0, y1 - y0};
  plan.region = with_margin(plan.work);

  for (std::size_t i = 0; i < plan.placements.size(); ++i) {
    for (Texel& corner : plan.placements[i].corners) {
      corner[0] -= plan.region.x;
      corner[1] -= plan.region.y;
    }
    add_jobs(shapes[i].corners, shapes[i].shown, static_cast<std::uint32_t>(i + 1), plan.region, nullptr,
             plan.jobs);
  }

  BlockMask touched(plan.region);
  for (const shader::RasterJob& job : plan.jobs) {
    touched.set[static_cast<std::size_t>(job.y / block) * touched.width + job.x / block] = 1;
  }
  const int reach = (gutter + block - 1) / block;
  const BlockMask changed = touched.dilated(reach, reach);
  const BlockMask seen = changed.dilated(reach, reach);
  plan.blocks = changed.list();
  plan.nearest_blocks = changed.dilated(0, reach).list();

  const auto mark = [&](const std::array<Texel, 3>& corners, std::uint32_t bit) {
    for_each_copy(transfer, bounds_of(corners), width, height, plan.region,
                  [&](const AxisCopy& x, const AxisCopy& y, const TexelBounds& bounds) {
                    add_jobs(fixed_corners(corners, x, y), bounds, bit, plan.region, &seen,
                             plan.foreign_jobs);
                  });
  };
  for (const auto& corners : transfer.foreign) mark(corners, shader::foreign_bit);
  for (const auto& corners : transfer.copies) mark(corners, shader::copy_key);
  // What does not show the image keeps others' gutters out all the same.
  for (std::size_t i = 0; i < transfer.faces.size(); ++i) {
    const TransferFace& face = transfer.faces[i];
    if (face.sheet != sheet || is_clipped(face, shown[i])) mark(face.texel, shader::sheet_bit);
  }
  return plan;
}

int working_bits(const Image& texture, std::size_t sheets) {
  return sheets > 1 ? 16 : texture.bits;
}

void round_to_8_bits(Image& texture) {
  for (std::uint16_t& value : texture.rgba) value = static_cast<std::uint16_t>((value + 128) / 257 * 257);
}

PlacedFace place_face(const Transfer& transfer, const Placement& placement, int cells) {
  const TransferFace& face = transfer.faces[placement.face];
  const ImageFrame& frame = transfer.image->frame;
  PlacedFace placed;

  // A face that has an area only once its corners are rounded is mapped from the rounded corners.
  std::array<Texel, 3> corners = placement.corners;
  const double rounded_area = doubled_area(rounded(corners));
  if (std::abs(doubled_area(corners)) < 0.5 * std::abs(rounded_area)) corners = rounded(corners);

  std::array<std::array<double, 2>, 3> pixels, plane;
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const Pixel pixel = frame.to_pixel(face.image[k]);
    pixels[k] = {pixel.x, pixel.y};
    plane[k] = {face.plane[k].real(), face.plane[k].imag()};
    const Texel &p = corners[k], &q = corners[(k + 1) % 3];
    longest = std::max(longest, std::hypot(q[0] - p[0], q[1] - p[1]));
  }
  const AffineMap to_pixels = affine_map(corners, pixels);
  placed.footprint = footprint_of(to_pixels, transfer.image->levels.size());
  placed.warped = !face.linear && transfer.warp && transfer.warp->steps > 0;
  const bool in_grid = cells > 0 || (placed.warped && transfer.warp->groups > 1);
  const double n = std::max(cells, 1);
  placed.map = in_grid         ? affine_map(corners, {{{0, 0}, {n, 0}, {0, n}}})
               : placed.warped ? affine_map(corners, plane)
                               : to_pixels;
  if (transfer.encoding == Encoding::normal) {
    std::array<std::array<double, 2>, 3> along;
    for (int k = 0; k < 3; ++k) along[k] = {face.along[k].real(), face.along[k].imag()};
    placed.along = affine_map(corners, along);
  }
  placed.clamped = std::abs(doubled_area(corners)) < longest;
  return placed;
}

}  // namespace applique
