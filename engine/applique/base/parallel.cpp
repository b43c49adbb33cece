#include "applique/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace applique {

void parallel_for(int count, const std::function<void(int)>& work) {
  const int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
  std::atomic<int> next = 0;
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < std::min(threads, count); ++i) pool.emplace_back(run);
  run();
  for (std::thread& thread : pool) thread.join();
}

void parallel_ranges(std::size_t count, std::size_t longest,
                     const std::function<void(std::size_t, std::size_t)>& work) {
  parallel_for(static_cast<int>((count + longest - 1) / longest), [&](int i) {
    const std::size_t first = longest * static_cast<std::size_t>(i);
    work(first, std::min(first + longest, count));
  });
}

}  // namespace applique
