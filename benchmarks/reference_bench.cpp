// A fixed loop, in every benchmark program: how fast the machine is in that run. Never change it: docs/benchmark_history.csv
// tells all other times as multiples of its.
#include <benchmark/benchmark.h>

#include <cstdint>

namespace {

/// 1000 steps of a damped swing that is pushed at random: chains of double arithmetic, a division, integers.
void reference_loop(benchmark::State& state) {
  state.SetLabel("a fixed loop: what the history's ratios are taken to");
  double x = 1.0, v = 0.0;
  std::uint64_t random = 1;
  for (auto _ : state) {
    for (int i = 0; i < 1000; ++i) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      const double push = (random >> 63) != 0 ? 0.25 / (1.5 + x * x) : -0.125;
      v += 0.001 * (push - 3.0 * x - 0.05 * v);
      x += 0.001 * v;
    }
    benchmark::DoNotOptimize(x);
  }
}
BENCHMARK(reference_loop);

}  // namespace
