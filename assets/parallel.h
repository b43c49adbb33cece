#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace applique::assets {

/// Calls `body(i)` for every i in [0, count), on all cores. The calls must not depend on each other.
template <class Body>
void parallel_for(int count, const Body& body) {
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) body(i);
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) threads.emplace_back(work);
  work();
}

}  // namespace applique::assets
