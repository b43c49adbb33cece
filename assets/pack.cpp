#include "pack.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>

namespace applique::assets {
namespace {

using Eigen::Vector2d;

constexpr int cells = 256;  // of the bitmap, a side
using Row = std::bitset<cells>;

struct Bitmap {
  int width = 0;
  int height = 0;
  std::vector<Row> rows;
};

/// The chart from the origin, turned by `angle`.
std::vector<Vector2d> turned(const std::vector<Vector2d>& uvs, double angle) {
  const Eigen::Rotation2Dd rotation(angle);
  std::vector<Vector2d> out;
  Vector2d low = Vector2d::Constant(1e300);
  for (const Vector2d& uv : uvs) {
    out.emplace_back(rotation * uv);
    low = low.cwiseMin(out.back());
  }
  for (Vector2d& uv : out) uv -= low;
  return out;
}

Vector2d extent(const std::vector<Vector2d>& uvs) {
  Vector2d high = Vector2d::Zero();
  for (const Vector2d& uv : uvs) high = high.cwiseMax(uv);
  return high;
}

/// The angle of the smallest box, to 3 degrees.
double best_angle(const std::vector<Vector2d>& uvs) {
  double best = 0;
  double least = 1e300;
  for (int i = 0; i < 30; ++i) {
    const double angle = i * std::numbers::pi / 60;
    const Vector2d box = extent(turned(uvs, angle));
    if (box.prod() < least) {
      least = box.prod();
      best = angle;
    }
  }
  return best;
}

/// Cells that the chart, scaled to cells, touches or comes within `margin` cells of; its origin is at cell
/// `margin`.
Bitmap draw(const FlatChart& chart, const std::vector<Vector2d>& uvs, double scale, int margin) {
  const Vector2d box = scale * extent(uvs);
  Bitmap bitmap;
  bitmap.width = static_cast<int>(box.x()) + 1 + 2 * margin;
  bitmap.height = static_cast<int>(box.y()) + 1 + 2 * margin;
  if (bitmap.width > cells || bitmap.height > cells) return bitmap;
  bitmap.rows.resize(bitmap.height);
  for (const Triangle& t : chart.triangles) {
    Vector2d low = scale * uvs[t[0]];
    Vector2d high = low;
    for (int i = 1; i < 3; ++i) {
      low = low.cwiseMin(scale * uvs[t[i]]);
      high = high.cwiseMax(scale * uvs[t[i]]);
    }
    // Triangles are small against charts: their boxes stand for them.
    for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()) + 2 * margin; ++y)
      for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()) + 2 * margin; ++x)
        bitmap.rows[y].set(x);
  }
  return bitmap;
}

struct Place {
  int x;
  int y;
  int turn;
};

bool fits(const std::vector<Row>& sheet, const Bitmap& bitmap, int x, int y) {
  for (int row = 0; row < bitmap.height; ++row)
    if ((sheet[y + row] & (bitmap.rows[row] << x)).any()) return false;
  return true;
}

/// The lowest, then leftmost place of any of the turns.
std::optional<Place> find_place(const std::vector<Row>& sheet, const std::array<Bitmap, 4>& turns) {
  for (int y = 0; y < cells; ++y)
    for (int turn = 0; turn < 4; ++turn) {
      const Bitmap& bitmap = turns[turn];
      if (bitmap.width > cells || y + bitmap.height > cells) continue;
      for (int x = 0; x + bitmap.width <= cells; ++x)
        if (fits(sheet, bitmap, x, y)) return Place{x, y, turn};
    }
  return std::nullopt;
}

}  // namespace

void pack(std::vector<FlatChart>& charts, int size, int gutter) {
  std::vector<std::array<std::vector<Vector2d>, 4>> turns(charts.size());
  double area = 0;
  for (std::size_t c = 0; c < charts.size(); ++c) {
    const double angle = best_angle(charts[c].uvs);
    for (int i = 0; i < 4; ++i) turns[c][i] = turned(charts[c].uvs, angle + i * std::numbers::pi / 2);
    area += extent(turns[c][0]).prod();
  }
  std::vector<std::size_t> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return extent(turns[a][0]).prod() > extent(turns[b][0]).prod();
  });
  const double cell = static_cast<double>(size) / cells;
  const int margin = static_cast<int>(std::ceil(0.5 * gutter / cell));
  double scale = 1.3 * cells / std::sqrt(area);
  std::vector<Place> places(charts.size());
  for (bool packed = false; !packed; scale *= 0.97) {
    std::vector<Row> sheet(cells);
    packed = true;
    for (const std::size_t c : order) {
      std::array<Bitmap, 4> bitmaps;
      for (int i = 0; i < 4; ++i) bitmaps[i] = draw(charts[c], turns[c][i], scale, margin);
      const auto place = find_place(sheet, bitmaps);
      if (!place) {
        packed = false;
        break;
      }
      places[c] = *place;
      const Bitmap& bitmap = bitmaps[place->turn];
      for (int row = 0; row < bitmap.height; ++row) sheet[place->y + row] |= bitmap.rows[row] << place->x;
    }
    if (packed)
      for (std::size_t c = 0; c < charts.size(); ++c)
        for (std::size_t v = 0; v < charts[c].uvs.size(); ++v)
          charts[c].uvs[v] = cell * (scale * turns[c][places[c].turn][v] +
                                     Vector2d(places[c].x + margin, places[c].y + margin));
  }
}

}  // namespace applique::assets
