#include "applique/warp/warp.h"

#include <algorithm>
#include <limits>

#include "applique/base/parallel.h"

namespace applique {
namespace {

// §3.1 and "vel" of §5.2 of the design. With beta_ij = 1 / (d_i^2 d_j^2), every weight is multiplied by
// d_m^2, m the nearest feature: nothing is divided by a small number, and at a feature only its own pairs are
// left, each of which moves it at its own velocity. With groups, d_k^2 stands for d_k^2 / a_k, a_k the ramped
// influence of k's group (§3.7), infinite where that is zero.
struct Scratch {
  Scratch(const Warp& warp, std::span<const double> influence) : inverse(warp.features) {
    if (warp.groups == 1) return;
    APPLIQUE_ASSERT(influence.size() == warp.groups);
    for (std::uint32_t k = 0; k < warp.features; ++k)
      share.push_back(influence_ramp(influence[warp.group[k]], warp.groups));
  }
  std::vector<double> share;    // a_k by feature; empty when there is one group
  std::vector<double> inverse;  // 1 / d_k^2, but 1 for m
};

Vec2 velocity_at(const Warp& warp, Vec2 p, std::uint32_t stage, Scratch& scratch) {
  std::vector<double>& inverse = scratch.inverse;
  const Vec2* position = warp.position.data() + std::size_t{stage} * warp.features;
  const Vec2* lambda = warp.lambda.data() + stage * warp.pairs.size();
  const Vec2* offset = warp.offset.data() + stage * warp.pairs.size();

  std::uint32_t nearest = 0;
  double nearest_squared = 0;
  for (std::uint32_t k = 0; k < warp.features; ++k) {
    double squared = std::norm(p - position[k]);
    if (!scratch.share.empty())
      squared = scratch.share[k] > 0 ? squared / scratch.share[k] : std::numeric_limits<double>::infinity();
    inverse[k] = squared;
    if (k == 0 || squared < nearest_squared) {
      nearest = k;
      nearest_squared = squared;
    }
  }
  for (double& value : inverse) value = 1 / value;
  inverse[nearest] = 1;

  double total = 0, lambda_x = 0, lambda_y = 0, offset_x = 0, offset_y = 0;
  for (std::size_t q = 0; q < warp.pairs.size(); ++q) {
    const auto [i, j] = warp.pairs[q];
    const bool near = i == nearest || j == nearest;
    const double weight = (near ? 1 : nearest_squared) * inverse[i] * inverse[j];
    total += weight;
    lambda_x += weight * lambda[q].real();
    lambda_y += weight * lambda[q].imag();
    offset_x += weight * offset[q].real();
    offset_y += weight * offset[q].imag();
  }
  const double x = p.real(), y = p.imag();
  return {(lambda_x * x - lambda_y * y + offset_x) / total, (lambda_x * y + lambda_y * x + offset_y) / total};
}

}  // namespace

double influence_ramp(double influence, std::uint32_t groups) {
  const double threshold = std::min(0.05, 0.5 / groups);
  const double x = std::clamp((influence - threshold) / (1 - 2 * threshold), 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

Vec2 Warp::velocity(Vec2 p, std::uint32_t stage, std::span<const double> influence) const {
  Scratch scratch(*this, influence);
  return velocity_at(*this, p, stage, scratch);
}

Vec2 Warp::operator()(Vec2 p, std::span<const double> influence) const {
  Scratch scratch(*this, influence);
  const double h = 1.0 / steps;
  for (std::uint32_t step = 0; step < steps; ++step) {
    const Vec2 k1 = velocity_at(*this, p, 3 * step, scratch);
    const Vec2 k2 = velocity_at(*this, p + 0.5 * h * k1, 3 * step + 1, scratch);
    const Vec2 k3 = velocity_at(*this, p + 0.5 * h * k2, 3 * step + 1, scratch);
    const Vec2 k4 = velocity_at(*this, p + h * k3, 3 * step + 2, scratch);
    p += h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return p;
}

Vec2 Warp::backward(Vec2 p, std::span<const double> influence) const {
  Scratch scratch(*this, influence);
  const double h = -1.0 / steps;
  for (std::uint32_t step = steps; step-- > 0;) {
    const Vec2 k1 = velocity_at(*this, p, 3 * step + 2, scratch);
    const Vec2 k2 = velocity_at(*this, p + 0.5 * h * k1, 3 * step + 1, scratch);
    const Vec2 k3 = velocity_at(*this, p + 0.5 * h * k2, 3 * step + 1, scratch);
    const Vec2 k4 = velocity_at(*this, p + h * k3, 3 * step, scratch);
    p += h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return p;
}

std::vector<Vec2> warp_all(const Warp& warp, const std::vector<Vec2>& places,
                           const std::vector<double>& influence) {
  if (warp.steps == 0) return places;
  const std::size_t groups = warp.groups;
  std::vector<Vec2> warped(places.size());
  parallel_ranges(places.size(), 256, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k)
      warped[k] =
          groups == 1 ? warp(places[k]) : warp(places[k], std::span(influence).subspan(k * groups, groups));
  });
  return warped;
}

}  // namespace applique
