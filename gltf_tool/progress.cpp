#include "progress.h"

#include <chrono>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace applique {
namespace {

constexpr auto first_draw = std::chrono::seconds(1);
constexpr auto redraw = std::chrono::milliseconds(100);
constexpr int bar_width = 24;
constexpr const char* clear_line = "\r\x1b[K";

}  // namespace

Progress::Progress(bool wanted) {
  if (wanted && isatty(STDERR_FILENO) != 0) thread_ = std::thread([this] { run(); });
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
  if (drawn_) std::fputs(clear_line, stderr);
}

void Progress::show(const std::string& stage, double done) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  done_ = done;
}

void Progress::run() {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, first_draw, [this] { return stopping_; });
  while (!stopping_) {
    draw();
    wake_.wait_for(lock, redraw, [this] { return stopping_; });
  }
}

void Progress::draw() {
  const int filled = static_cast<int>(done_ * bar_width);
  const std::string bar = std::string(filled, '#') + std::string(bar_width - filled, '.');
  std::fputs(
      fmt::format("{}[{}] {:3.0f} % {} ({:.1f} s)", clear_line, bar, 100 * done_, stage_, watch_.seconds())
          .c_str(),
      stderr);
  drawn_ = true;
}

}  // namespace applique
