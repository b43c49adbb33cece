// The solve by the patch's size, on a smooth bump and on one so steep that the isometric map must descend;
// and on one patch by the surface's size, which must not matter.

#include <benchmark/benchmark.h>

#include "applique/decal.h"

#include "support/shapes.h"

namespace applique {
namespace {

Region whole_image() {
  return *Region::from_contour({{0, 0}, {512, 0}, {512, 512}, {0, 512}}, ImageFrame{512, 512});
}

DecalInput five_pins(const SurfaceMesh& surface, double half_size) {
  DecalInput input{"bench", whole_image(), {}, {}};
  for (const auto& [x, y] : {std::pair(130, 150), std::pair(380, 150), std::pair(256, 270),
                             std::pair(180, 400), std::pair(340, 390)}) {
    const Vec3 place(half_size * (x - 256) / 256, half_size * (256 - y) / 256, 0);
    input.features.push_back({{double(x), double(y)}, shapes::nearest(surface, place)});
  }
  return input;
}

void solve(benchmark::State& state, const SurfaceMesh& surface, const DecalInput& input) {
  std::size_t faces = 0;
  for (auto _ : state) {
    const auto map = solve_decal(surface, input);
    if (!map) state.SkipWithError(map.error().message.c_str());
    faces = map->patch.faces.size();
  }
  state.counters["faces"] = static_cast<double>(faces);
}

void smooth_bump(benchmark::State& state) {
  const SurfaceMesh surface = shapes::bump(static_cast<int>(state.range(0)), 0.4, 0.4).weld();
  solve(state, surface, five_pins(surface, 0.8));
}
BENCHMARK(smooth_bump)->RangeMultiplier(2)->Range(16, 128)->Unit(benchmark::kMillisecond);

void steep_bump(benchmark::State& state) {
  const SurfaceMesh surface = shapes::bump(static_cast<int>(state.range(0)), 2, 0.2).weld();
  solve(state, surface, five_pins(surface, 0.8));
}
BENCHMARK(steep_bump)->RangeMultiplier(2)->Range(16, 64)->Unit(benchmark::kMillisecond);

void patch_on_a_growing_plane(benchmark::State& state) {
  const auto cells = static_cast<int>(state.range(0));
  const double size = cells / 64.0;
  SurfaceMesh surface = shapes::grid(cells, cells, [&](double s, double t) {
                          return Vec3((2 * s - 1) * size, (2 * t - 1) * size, 0);
                        }).weld();
  solve(state, surface, five_pins(surface, 0.5));
}
BENCHMARK(patch_on_a_growing_plane)->RangeMultiplier(2)->Range(64, 512)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace applique
