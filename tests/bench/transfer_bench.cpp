// Per-pixel transfer: a decal over about half a million texels of a 2048 x 2048 texture.
#include <memory>

#include <benchmark/benchmark.h>

#include "applique/gpu/gpu_transfer.h"

#include "gpu/synthetic_transfer.h"

namespace applique {
namespace {

SyntheticTransfer decal(int features, double nonlinear) {
  SyntheticOptions options;
  options.texture = 2048;
  options.image = 1024;
  options.features = features;
  options.grid = 54;
  options.extent = 0.38;
  options.nonlinear = nonlinear;
  return synthetic_transfer(1, options);
}

// Device, pipelines and transfer, as a command that runs once does it.
void transfer_from_nothing(benchmark::State& state) {
  const SyntheticTransfer synthetic = decal(6, static_cast<double>(state.range(0)) / 100);
  const Image texture = noise_texture(1, 2048, 2048);
  while (state.KeepRunning()) {
    Image result = texture;
    const Device device = Device::create({"", false}).value();
    GpuTransfer gpu = GpuTransfer::create(device).value();
    benchmark::DoNotOptimize(gpu.run(synthetic.transfer, result).value());
  }
}
BENCHMARK(transfer_from_nothing)->Arg(0)->Arg(5)->Arg(100)->Unit(benchmark::kMillisecond)->Iterations(1);

void transfer_on_gpu(benchmark::State& state) {
  const SyntheticTransfer synthetic =
      decal(static_cast<int>(state.range(0)), static_cast<double>(state.range(1)) / 100);
  const Image texture = noise_texture(1, 2048, 2048);
  const Device device = Device::create({"", false}).value();
  GpuTransfer gpu = GpuTransfer::create(device).value();
  std::uint64_t texels = 0;
  while (state.KeepRunning()) {
    Image result = texture;
    texels = gpu.run(synthetic.transfer, result).value().covered_texels;
  }
  state.counters["texels"] = static_cast<double>(texels);
}
BENCHMARK(transfer_on_gpu)->ArgsProduct({{6, 10}, {0, 5, 100}})->Unit(benchmark::kMillisecond);

void transfer_on_cpu_twin(benchmark::State& state) {
  const SyntheticTransfer synthetic =
      decal(static_cast<int>(state.range(0)), static_cast<double>(state.range(1)) / 100);
  const Image texture = noise_texture(1, 2048, 2048);
  while (state.KeepRunning()) {
    Image result = texture;
    benchmark::DoNotOptimize(transfer_on_cpu(synthetic.transfer, result));
  }
}
BENCHMARK(transfer_on_cpu_twin)->ArgsProduct({{6}, {0, 5, 100}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace applique
