// A stride of a planar leg by the integrator of order 8, with events, alone and with its energies.
#include <benchmark/benchmark.h>

#include "host/gait/fourier_gait.hpp"
#include "host/gait/search.hpp"

namespace {

using namespace furcula::gait;

const Gait& hop() {
  static const Gait gait = [] {
    Query query;
    query.machine = spear(LegSpring::switched);
    query.task.clearance_m = 0.075;
    query.fourier = true;
    query.starts = 1;
    return *find_gait(query).gait;
  }();
  return gait;
}

void stride(benchmark::State& state, bool energies) {
  const FourierGait& gait = std::get<FourierGait>(hop().motion);
  const FourierLaw<double> law(gait.law);
  StrideOptions options;
  options.longest_step_s = 8e-3;
  options.energies = energies;
  state.SetLabel(energies ? "a planar leg's stride with events and energies, order 8"
                          : "a planar leg's stride with events, order 8");
  for (auto _ : state)
    benchmark::DoNotOptimize(run_stride<double>(hop().machine, law, law, gait.apex, options).apex);
}
void planar_leg_stride(benchmark::State& state) { stride(state, false); }
void planar_leg_stride_with_energies(benchmark::State& state) { stride(state, true); }
BENCHMARK(planar_leg_stride);
BENCHMARK(planar_leg_stride_with_energies);

void gait_in_place_from_a_cold_start(benchmark::State& state) {
  const Machine machine = spear(LegSpring::switched);
  Task task;
  task.clearance_m = 0.075;
  state.SetLabel("the cheapest hop in place of a planar leg, from a rough one");
  for (auto _ : state)
    benchmark::DoNotOptimize(find_free_gait(machine, task, rough_gait(machine, task, 0), {}).gait.cost);
}
BENCHMARK(gait_in_place_from_a_cold_start)->Unit(benchmark::kMillisecond);

}  // namespace
