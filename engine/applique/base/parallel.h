#pragma once

#include <functional>

namespace applique {

/// Runs `work(i)` for each i in [0, count), on all cores, in no order; returns when all are done. `work` does
/// not throw.
void parallel_for(int count, const std::function<void(int)>& work);

}  // namespace applique
