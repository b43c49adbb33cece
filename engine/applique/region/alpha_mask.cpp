#include "applique/region/alpha_mask.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace applique {
namespace {

/// Union-find over small numbers; the smallest of a set stands for it.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t add() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Pixels first..last-1 of a row that have the same value, and the component they belong to.
struct Run {
  int row, first, last;
  std::uint32_t label;
};

/// The runs of `value`, row by row; runs of neighbouring rows belong together when they overlap, or with
/// `reach` 1 when they touch at a corner.
std::vector<Run> find_runs(const AlphaMask& mask, std::uint8_t value, int reach) {
  std::vector<Run> runs;
  Sets sets(0);
  std::size_t above = 0, above_end = 0;
  for (int y = 0; y < mask.height; ++y) {
    const std::size_t row_start = runs.size();
    const std::uint8_t* row = &mask.bits[mask.index(0, y)];
    const std::uint8_t* end = row + mask.width;
    for (const std::uint8_t* at = row; at < end;) {
      const auto* first = static_cast<const std::uint8_t*>(std::memchr(at, value, end - at));
      if (!first) break;
      const auto* last = static_cast<const std::uint8_t*>(std::memchr(first, 1 - value, end - first));
      if (!last) last = end;
      Run run = {y, static_cast<int>(first - row), static_cast<int>(last - row), sets.add()};
      while (above < above_end && runs[above].last + reach <= run.first) ++above;
      for (std::size_t k = above; k < above_end && runs[k].first < run.last + reach; ++k) {
        sets.unite(runs[k].label, run.label);
      }
      runs.push_back(run);
      at = last;
    }
    above = row_start;
    above_end = runs.size();
  }
  for (Run& run : runs) run.label = sets.find(run.label);
  return runs;
}

struct Site {
  int x, y;
};

/// The shortest known line between two islands.
struct Bridge {
  std::int64_t length;  ///< Squared.
  Site a, b;
  std::uint32_t label_a, label_b;
  bool operator<(const Bridge& other) const {
    return std::tie(length, a.y, a.x, b.y, b.x) <
           std::tie(other.length, other.a.y, other.a.x, other.b.y, other.b.x);
  }
};

/// The nearest island pixel of each pixel of a row, from the nearest one in each column: the lower envelope
/// of parabolas (Felzenszwalb and Huttenlocher 2012, "Distance transforms of sampled functions").
class RowEnvelope {
 public:
  explicit RowEnvelope(int width) : columns_(width), starts_(width), heights_(width) {}

  void nearest(int y, const std::int32_t* column_sites, std::vector<Site>& result) {
    const int width = static_cast<int>(result.size());
    int count = 0;
    for (int x = 0; x < width; ++x) {
      if (column_sites[x] < 0) continue;
      const double dy = y - column_sites[x];
      const double height = dy * dy + static_cast<double>(x) * x;
      double start = -1;
      while (count > 0) {
        start = (height - heights_[count - 1]) / (2.0 * (x - columns_[count - 1]));
        if (start > starts_[count - 1]) break;
        --count;
      }
      columns_[count] = x;
      heights_[count] = height;
      starts_[count] = count == 0 ? -std::numeric_limits<double>::infinity() : start;
      ++count;
    }
    int k = 0;
    for (int x = 0; x < width; ++x) {
      while (k + 1 < count && starts_[k + 1] < x) ++k;
      result[x] = {columns_[k], column_sites[columns_[k]]};
    }
  }

 private:
  std::vector<int> columns_;
  std::vector<double> starts_, heights_;
};

/// For each pixel the row of the nearest island pixel in its column; -1 in an empty column.
std::vector<std::int32_t> nearest_in_columns(const AlphaMask& mask) {
  std::vector<std::int32_t> sites(mask.bits.size(), -1);
  for (int y = 1; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      sites[mask.index(x, y)] = mask.has(x, y) ? y : sites[mask.index(x, y - 1)];
    }
  }
  for (int y = mask.height - 2; y >= 0; --y) {
    for (int x = 0; x < mask.width; ++x) {
      std::int32_t& site = sites[mask.index(x, y)];
      const std::int32_t below = sites[mask.index(x, y + 1)];
      if (below >= 0 && (site < 0 || below - y < y - site)) site = below;
    }
  }
  return sites;
}

/// Islands are neighbours where their nearest-pixel cells touch; every edge of their minimum spanning tree is
/// between neighbours, and its line stays in the two cells, so that it meets no third island.
std::vector<Bridge> neighbour_bridges(const AlphaMask& mask, const std::vector<std::uint32_t>& labels) {
  const std::vector<std::int32_t> column_sites = nearest_in_columns(mask);
  std::unordered_map<std::uint64_t, Bridge> shortest;
  const auto consider = [&](Site a, Site b) {
    std::uint32_t label_a = labels[mask.index(a.x, a.y)], label_b = labels[mask.index(b.x, b.y)];
    if (label_a == label_b) return;
    if (label_a > label_b) {
      std::swap(a, b);
      std::swap(label_a, label_b);
    }
    const std::int64_t dx = a.x - b.x, dy = a.y - b.y;
    const Bridge bridge = {dx * dx + dy * dy, a, b, label_a, label_b};
    const auto [known, added] = shortest.try_emplace((std::uint64_t{label_a} << 32) | label_b, bridge);
    if (!added && bridge < known->second) known->second = bridge;
  };
  RowEnvelope envelope(mask.width);
  std::vector<Site> above(mask.width), row(mask.width);
  for (int y = 0; y < mask.height; ++y) {
    envelope.nearest(y, &column_sites[mask.index(0, y)], row);
    for (int x = 0; x < mask.width; ++x) {
      if (x > 0 && (row[x].x != row[x - 1].x || row[x].y != row[x - 1].y)) consider(row[x - 1], row[x]);
      if (y > 0 && (row[x].x != above[x].x || row[x].y != above[x].y)) consider(above[x], row[x]);
    }
    std::swap(above, row);
  }
  std::vector<Bridge> bridges;
  bridges.reserve(shortest.size());
  for (const auto& entry : shortest) bridges.push_back(entry.second);
  std::sort(bridges.begin(), bridges.end());
  return bridges;
}

void draw_line(AlphaMask& mask, Site a, Site b) {
  const int steps = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
  for (int i = 1; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    mask.bits[mask.index(static_cast<int>(std::lround(a.x + t * (b.x - a.x))),
                         static_cast<int>(std::lround(a.y + t * (b.y - a.y))))] = 1;
  }
}

}  // namespace

AlphaMask make_alpha_mask(const Image& image, double threshold) {
  AlphaMask mask;
  mask.width = image.width + 2;
  mask.height = image.height + 2;
  mask.bits.assign(static_cast<std::size_t>(mask.width) * mask.height, 0);
  const double limit =
      std::floor(65535 * threshold);  // A whole number is over t exactly if it is over floor(t).
  for (int y = 0; y < image.height; ++y) {
    const std::uint16_t* in = image.pixel(0, y);
    std::uint8_t* out = &mask.bits[mask.index(1, y + 1)];
    for (int x = 0; x < image.width; ++x) out[x] = in[4 * x + 3] > limit ? 1 : 0;
  }
  return mask;
}

void fill_holes(AlphaMask& mask) {
  const std::vector<Run> runs = find_runs(mask, 0, 0);
  for (const Run& run : runs) {
    if (run.label == runs[0].label) continue;  // The border row is the outside.
    std::fill_n(&mask.bits[mask.index(run.first, run.row)], run.last - run.first, std::uint8_t{1});
  }
}

void bridge_islands(AlphaMask& mask) {
  const std::vector<Run> runs = find_runs(mask, 1, 1);
  if (std::all_of(runs.begin(), runs.end(), [&](const Run& run) { return run.label == runs[0].label; }))
    return;
  std::vector<std::uint32_t> labels(mask.bits.size());
  for (const Run& run : runs) {
    std::fill_n(&labels[mask.index(run.first, run.row)], run.last - run.first, run.label);
  }
  Sets joined(runs.size());
  for (const Bridge& bridge : neighbour_bridges(mask, labels)) {
    if (joined.unite(bridge.label_a, bridge.label_b)) draw_line(mask, bridge.a, bridge.b);
  }
  fill_holes(mask);
}

}  // namespace applique
