#include "uv_atlas.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "applique/base/error.h"

namespace applique {
namespace {

/// The lower border of what has been put: steps from left to right, each reaching to the next one's start.
struct Step {
  int x = 0;
  int y = 0;
};

class Skyline {
 public:
  explicit Skyline(int width) : width_(width), steps_{{0, 0}} {}

  void place(AtlasBox& box) {
    std::size_t best = steps_.size();
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + box.width <= width_; ++i) {
      const int y = height_over(i, box.width);
      if (best == steps_.size() || y < box.y) {
        best = i;
        box.x = steps_[i].x;
        box.y = y;
      }
    }
    APPLIQUE_ASSERT(best < steps_.size());
    cover(best, box);
  }

 private:
  [[nodiscard]] int height_over(std::size_t first, int width) const {
    int y = 0;
    for (std::size_t i = first; i < steps_.size() && steps_[i].x < steps_[first].x + width; ++i)
      y = std::max(y, steps_[i].y);
    return y;
  }

  void cover(std::size_t first, const AtlasBox& box) {
    const int end = box.x + box.width;
    std::size_t last = first;
    while (last + 1 < steps_.size() && steps_[last + 1].x <= end) ++last;
    const int rest = steps_[last].y;  // the height that goes on beyond the box
    const auto begin = steps_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto next = steps_.erase(begin, steps_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    std::vector<Step> added = {{box.x, box.y + box.height}};
    const bool gap = next == steps_.end() ? end < width_ : end < next->x;
    if (gap) added.push_back({end, rest});
    steps_.insert(next, added.begin(), added.end());
  }

  int width_;
  std::vector<Step> steps_;
};

}  // namespace

int pack_boxes(std::vector<AtlasBox>& boxes, int width) {
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return boxes[a].height > boxes[b].height; });
  Skyline skyline(width);
  int height = 0;
  for (const std::size_t i : order) {
    skyline.place(boxes[i]);
    height = std::max(height, boxes[i].y + boxes[i].height);
  }
  return height;
}

std::optional<std::array<int, 2>> pack_atlas(std::vector<AtlasBox>& boxes, int fineness, int most) {
  std::int64_t area = 0;
  int widest = 1;
  for (const AtlasBox& box : boxes) {
    area += std::int64_t{box.width} * box.height;
    widest = std::max(widest, box.width);
    if (box.width > most || box.height > most) return std::nullopt;
  }
  area *= fineness * fineness;
  if (area > std::int64_t{most} * most) return std::nullopt;
  const auto size_of = [](const std::array<int, 2>& sides) {
    return std::pair(std::int64_t{sides[0]} * sides[1], sides[0] + sides[1]);
  };
  std::optional<std::array<int, 2>> best;
  std::vector<AtlasBox> placed = boxes;
  // Widths that are not far from a square's side.
  constexpr int longest = 4;
  for (int width = 1; width <= most && std::int64_t{width} * width <= longest * longest * area; width *= 2) {
    if (width / fineness < widest || std::int64_t{width} * width * longest * longest < area) continue;
    const std::int64_t height = std::int64_t{fineness} * pack_boxes(placed, width / fineness);
    if (height > most) continue;
    const std::array<int, 2> sides = {width, static_cast<int>(std::bit_ceil(static_cast<unsigned>(height)))};
    if (sides[1] > most || (best && size_of(sides) >= size_of(*best))) continue;
    best = sides;
    boxes = placed;
  }
  return best;
}

}  // namespace applique
