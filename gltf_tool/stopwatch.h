#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace applique {

/// Seconds since it was made or last lapped.
class Stopwatch {
 public:
  /// Seconds so far.
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }
  /// Seconds so far; starts again.
  double lap() {
    const double elapsed = seconds();
    start_ = Clock::now();
    return elapsed;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Seconds by stage, in the order in which the stages first came.
class StageTimes {
 public:
  void add(const std::string& stage, double seconds) {
    for (auto& [name, sum] : stages_)
      if (name == stage) {
        sum += seconds;
        return;
      }
    stages_.emplace_back(stage, seconds);
  }
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
};

}  // namespace applique
