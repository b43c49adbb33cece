#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "stopwatch.h"

namespace applique {

/// A progress bar on the terminal that stderr is, for work that has gone on for more than a second. Draws
/// nothing if stderr is no terminal, or if not `wanted`. The bar goes away with the object.
class Progress {
 public:
  explicit Progress(bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// What is being done now, and the share of all the work that lies behind, 0..1. Callable from any thread.
  void show(const std::string& stage, double done);

 private:
  void run();
  void draw();

  Stopwatch watch_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  bool drawn_ = false;
  std::string stage_;
  double done_ = 0;
  std::thread thread_;  ///< Draws; not started where there is nothing to draw on.
};

}  // namespace applique
