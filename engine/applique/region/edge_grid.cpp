#include "applique/region/edge_grid.h"

#include <cmath>

#include "applique/base/predicates.h"

namespace applique {
namespace {

/// A point where the segments a b and c d meet, if they do.
std::optional<Vec2> meeting_point(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (!boxes_meet(a, b, c, d)) return std::nullopt;
  const int oc = orientation(a, b, c), od = orientation(a, b, d);
  if (oc * od > 0) return std::nullopt;
  const int oa = orientation(c, d, a), ob = orientation(c, d, b);
  if (oa * ob > 0) return std::nullopt;
  if (oc == 0 && in_box(c, a, b)) return c;
  if (od == 0 && in_box(d, a, b)) return d;
  if (oa == 0 && in_box(a, c, d)) return a;
  if (ob == 0 && in_box(b, c, d)) return b;
  if (oc * od == 0 || oa * ob == 0) return std::nullopt;
  const double t = cross(c - a, d - c) / cross(b - a, d - c);
  return a + t * (b - a);
}

}  // namespace

bool in_box(Vec2 z, Vec2 a, Vec2 b) {
  return std::min(a.real(), b.real()) <= z.real() && z.real() <= std::max(a.real(), b.real()) &&
         std::min(a.imag(), b.imag()) <= z.imag() && z.imag() <= std::max(a.imag(), b.imag());
}

bool boxes_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return std::max(a.real(), b.real()) >= std::min(c.real(), d.real()) &&
         std::max(c.real(), d.real()) >= std::min(a.real(), b.real()) &&
         std::max(a.imag(), b.imag()) >= std::min(c.imag(), d.imag()) &&
         std::max(c.imag(), d.imag()) >= std::min(a.imag(), b.imag());
}

std::optional<Vec2> improper_meeting(const std::vector<Vec2>& polygon, std::uint32_t e, std::uint32_t f) {
  const auto n = static_cast<std::uint32_t>(polygon.size());
  const auto end = [&](std::uint32_t edge) { return polygon[edge + 1 == n ? 0 : edge + 1]; };
  const bool follows = f == e + 1, precedes = e == 0 && f == n - 1;
  if (!follows && !precedes) return meeting_point(polygon[e], end(e), polygon[f], end(f));
  const Vec2 before = follows ? polygon[e] : polygon[f];
  const Vec2 shared = follows ? polygon[f] : polygon[e];
  const Vec2 after = follows ? end(f) : end(e);
  if (orientation(before, shared, after) == 0 && dot(shared - before, after - shared) < 0) return shared;
  return std::nullopt;
}

EdgeGrid::EdgeGrid(const std::vector<Vec2>& polygon) {
  Vec2 low = polygon[0], high = polygon[0];
  for (const Vec2 z : polygon) {
    low = {std::min(low.real(), z.real()), std::min(low.imag(), z.imag())};
    high = {std::max(high.real(), z.real()), std::max(high.imag(), z.imag())};
  }
  const Vec2 extent = high - low;
  const double wanted = std::clamp(16.0 * static_cast<double>(polygon.size()), 1024.0, 262144.0);
  const double longest = std::max(extent.real(), extent.imag());
  // A region as thin as a line gets cells by its length alone.
  size_ = std::max(std::sqrt(extent.real() * extent.imag() / wanted), longest / wanted);
  inverse_ = 1 / size_;
  columns_ = static_cast<int>(extent.real() * inverse_) + 3;
  rows_ = static_cast<int>(extent.imag() * inverse_) + 3;
  origin_ = 0.5 * (low + high) - 0.5 * size_ * Vec2(columns_, rows_);

  const auto for_each_entry = [&](auto&& entry) {
    for (std::uint32_t i = 0; i < polygon.size(); ++i) {
      visit_cells(polygon[i], polygon[(i + 1) % polygon.size()], [&](int cell) {
        entry(cell, i);
        return true;
      });
    }
  };
  first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  for_each_entry([&](int cell, std::uint32_t) { ++first_[cell + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  edges_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_entry([&](int cell, std::uint32_t edge) { edges_[next[cell]++] = edge; });
}

}  // namespace applique
