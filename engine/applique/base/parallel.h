#pragma once

#include <cstddef>
#include <functional>

namespace applique {

/// Runs `work(i)` for each i in [0, count), on all cores, in no order; returns when all are done. `work` does
/// not throw.
void parallel_for(int count, const std::function<void(int)>& work);

/// The same for loops with little work in each step: runs `work(first, last)` for ranges of at most `longest`
/// steps that together are [0, count). The ranges do not depend on the number of cores.
void parallel_ranges(std::size_t count, std::size_t longest,
                     const std::function<void(std::size_t first, std::size_t last)>& work);

}  // namespace applique
