// Large patches, up to a million triangles: the solve by stage, and the solvers of Laplacians against one
// another.

#include <algorithm>
#include <cmath>

#include <benchmark/benchmark.h>

#include "applique/base/laplacian_solver.h"
#include "applique/base/stage_timer.h"
#include "applique/decal.h"

#include "support/hills_decal.h"
#include "support/laplacians.h"
#include "support/shapes.h"

namespace applique {
namespace {

void large_patch(benchmark::State& state) {
  const SurfaceMesh surface = shapes::hills(static_cast<int>(state.range(0))).weld();
  const DecalInput input = hills_decal(surface);
  for (auto _ : state) {
    const auto map = solve_decal(surface, input);
    if (!map) return state.SkipWithError(map.error().message.c_str());
    state.counters["faces"] = static_cast<double>(map->patch.faces.size());
    state.counters["solves"] = map->solves;
    state.counters["flips"] = map->quality.flipped_plane + map->quality.flipped_image;
    state.counters["seed"] = map->times.graph + map->times.seed;
    state.counters["embed"] = map->times.embed;
    state.counters["warp"] = map->times.warp;
    state.counters["grow"] = map->times.grow;
    state.counters["quality"] = map->times.quality;
  }
}
// 10 thousand, 100 thousand and a million triangles under the image.
BENCHMARK(large_patch)
    ->ArgsProduct({{77, 243, 769}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->MeasureProcessCPUTime();

/// One system by either way: the seconds that the matrix takes, and those of both coordinates' solution.
void solve_laplacian(benchmark::State& state, std::size_t most_factored) {
  const Eigen::SparseMatrix<double> lower =
      laplacians::cotangent(shapes::hills(static_cast<int>(state.range(0))),
                            [](const Vec3& p) { return std::max(std::abs(p.x()), std::abs(p.y())) == 1; });
  const Eigen::VectorXcd right = Eigen::VectorXcd::Random(lower.rows());
  double compute = 0, solve = 0;
  for (auto _ : state) {
    LaplacianSolver solver({most_factored});
    {
      StageTimer timer(compute);
      if (!solver.compute(lower)) return state.SkipWithError("singular");
    }
    StageTimer timer(solve);
    benchmark::DoNotOptimize(solver.solve(right).data());
  }
  state.counters["unknowns"] = static_cast<double>(lower.rows());
  state.counters["compute"] = benchmark::Counter(compute, benchmark::Counter::kAvgIterations);
  state.counters["solve"] = benchmark::Counter(solve, benchmark::Counter::kAvgIterations);
}
void laplacian_sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int cells : {77, 128, 180, 243, 340, 769}) benchmark->Arg(cells);
  benchmark->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
}
BENCHMARK_CAPTURE(solve_laplacian, by_factors, ~std::size_t{0})->Apply(laplacian_sizes);
BENCHMARK_CAPTURE(solve_laplacian, by_multigrid, std::size_t{0})->Apply(laplacian_sizes);

}  // namespace
}  // namespace applique
