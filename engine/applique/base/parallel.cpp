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

}  // namespace applique
