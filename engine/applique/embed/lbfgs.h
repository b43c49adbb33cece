#pragma once

#include <array>
#include <deque>
#include <utility>

#include "applique/embed/triangle_energy.h"

namespace applique {

/// The steps last taken, by which L-BFGS corrects an operator that stands for the inverse Hessian (two-loop
/// recursion, Nocedal 1980).
class StepHistory {
 public:
  static double inner(const PlanePoints& p, const PlanePoints& q) { return p.dot(q).real(); }

  void clear() { steps_.clear(); }

  /// `step` of the places, and the `change` of the gradient over it.
  void add(PlanePoints step, PlanePoints change) {
    const double curvature = inner(step, change);
    if (!(curvature > 0)) return;
    steps_.push_back({std::move(step), std::move(change), curvature});
    if (steps_.size() > memory) steps_.pop_front();
  }

  /// The way down: `solve` applies the operator.
  template <class Solve>
  [[nodiscard]] PlanePoints direction(const Solve& solve, PlanePoints gradient) const {
    std::array<double, memory> share;
    for (std::size_t i = steps_.size(); i-- > 0;) {
      share[i] = inner(steps_[i].step, gradient) / steps_[i].curvature;
      gradient -= share[i] * steps_[i].change;
    }
    PlanePoints direction = solve(gradient);
    for (std::size_t i = 0; i < steps_.size(); ++i)
      direction += (share[i] - inner(steps_[i].change, direction) / steps_[i].curvature) * steps_[i].step;
    return -direction;
  }

 private:
  static constexpr std::size_t memory = 5;
  struct Step {
    PlanePoints step, change;
    double curvature;
  };
  std::deque<Step> steps_;
};

}  // namespace applique
