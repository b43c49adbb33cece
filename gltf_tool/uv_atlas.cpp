#include "uv_atlas.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

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

int round_up(std::int64_t value, int step) {
  return static_cast<int>((value + step - 1) / step * step);
}

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

std::optional<std::array<int, 2>> pack_atlas(std::vector<AtlasBox>& boxes, int step, int most) {
  std::int64_t area = 0;
  int widest = 1;
  for (const AtlasBox& box : boxes) {
    area += std::int64_t{box.width} * box.height;
    widest = std::max(widest, box.width);
    if (box.width > most || box.height > most) return std::nullopt;
  }
  if (area > std::int64_t{most} * most) return std::nullopt;
  std::optional<std::array<int, 2>> best;
  std::vector<AtlasBox> placed = boxes;
  // From a square's side on, a few widths: the packing wastes less in one than in another.
  int width = 1;
  while (std::int64_t{width} * width < area) width *= 2;
  for (int tried = std::max(round_up(widest, step), round_up(width / 2, step)), i = 0; i < 8; ++i) {
    const int side = std::min(tried, most / step * step);
    if (side < widest) break;
    const int height = round_up(pack_boxes(placed, side), step);
    if (height <= most && (!best || std::int64_t{side} * height < std::int64_t{(*best)[0]} * (*best)[1])) {
      best = {side, height};
      boxes = placed;
    }
    if (side != tried) break;
    tried = round_up(std::int64_t{tried} * 5 / 4 + 1, step);
  }
  return best;
}

}  // namespace applique
