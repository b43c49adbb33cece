#include "applique/image/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace applique {
namespace {

// Rounding of the running sums: anything nearer to empty or full is empty or full.
constexpr double negligible = 1e-9;

/// Signed areas to the right of the edges, as differences along each row: their running sum is the coverage.
class Accumulator {
 public:
  Accumulator(int width, int height)
      : width_(width),
        height_(height),
        stride_(static_cast<std::size_t>(width) + 2),
        sums_(stride_ * height) {}

  /// An edge anywhere; what lies left of the image counts from its first column, what lies right not at all.
  void add_edge(Pixel a, Pixel b) {
    if (a.y == b.y) return;
    const double direction = a.y < b.y ? 1 : -1;
    if (a.y > b.y) std::swap(a, b);
    const double slope = (b.x - a.x) / (b.y - a.y);
    const auto at = [&](double y) { return y <= a.y ? a.x : y >= b.y ? b.x : a.x + (y - a.y) * slope; };
    const double top = std::max(a.y, 0.0), bottom = std::min(b.y, static_cast<double>(height_));
    if (top >= bottom) return;
    for (int row = static_cast<int>(top); row < bottom; ++row) {
      add_in_row(row, at(std::max<double>(row, top)), at(std::min<double>(row + 1, bottom)),
                 direction * (std::min<double>(row + 1, bottom) - std::max<double>(row, top)));
    }
  }

  [[nodiscard]] std::vector<float> coverage() const {
    std::vector<float> result(static_cast<std::size_t>(width_) * height_);
    for (int y = 0; y < height_; ++y) {
      const double* in = &sums_[stride_ * y];
      float* out = &result[static_cast<std::size_t>(width_) * y];
      double sum = 0;
      for (int x = 0; x < width_; ++x) {
        sum += in[x];
        const double covered = std::abs(sum);
        out[x] = covered < negligible ? 0.0F : covered > 1 - negligible ? 1.0F : static_cast<float>(covered);
      }
    }
    return result;
  }

 private:
  /// A piece of an edge within one row, of signed height `dy`: split where it enters and leaves the image.
  void add_in_row(int row, double x0, double x1, double dy) {
    if (x0 > x1) std::swap(x0, x1);
    const double right = width_;
    if (x0 >= right) return;
    if (x1 <= 0) {
      add_inside(row, 0, 0, dy);
    } else if (x0 < 0) {
      add_inside(row, 0, 0, dy * (0 - x0) / (x1 - x0));
      add_in_row(row, 0, x1, dy * x1 / (x1 - x0));
    } else if (x1 > right) {
      add_inside(row, x0, right, dy * (right - x0) / (x1 - x0));
    } else {
      add_inside(row, x0, x1, dy);
    }
  }

  // The area right of the piece up to x = i + 1, summed over pixels, grows from 0 to dy: add its differences.
  void add_inside(int row, double x0, double x1, double dy) {
    double* sums = &sums_[stride_ * row];
    const int first = static_cast<int>(x0), last = static_cast<int>(x1);
    if (first == last) {
      const double covered = dy * (first + 1 - 0.5 * (x0 + x1));
      sums[first] += covered;
      sums[first + 1] += dy - covered;
      return;
    }
    const double rate = dy / (x1 - x0);
    double before = 0;  // Coverage of the pixel to the left.
    for (int x = first; x <= last; ++x) {
      const double from = std::max<double>(x0, x), to = std::min<double>(x1, x + 1);
      const double passed = rate * (from - x0);  // Height of the piece left of this pixel: covers all of it.
      const double covered = passed + rate * (to - from) * (x + 1 - 0.5 * (from + to));
      sums[x] += covered - before;
      before = covered;
    }
    sums[last + 1] += dy - before;
  }

  int width_, height_;
  std::size_t stride_;
  std::vector<double> sums_;
};

}  // namespace

std::vector<float> polygon_coverage(const std::vector<Pixel>& polygon, int width, int first_row,
                                    int last_row) {
  Accumulator accumulator(width, last_row - first_row);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Pixel a = polygon[i], b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    accumulator.add_edge({a.x, a.y - first_row}, {b.x, b.y - first_row});
  }
  return accumulator.coverage();
}

}  // namespace applique
