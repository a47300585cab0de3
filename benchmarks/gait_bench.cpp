// A stride of a planar leg by the integrator of order 8, with events, alone and with its energies.
#include <benchmark/benchmark.h>

#include "host/gait/fourier_gait.hpp"
#include "host/gait/search.hpp"

namespace {

using namespace furcula::gait;

/// In place at 7.5 cm: with the print's 49 parameters, or of free torques.
const Gait& hop(bool fourier) {
  const auto find = [](bool with_parameters) {
    Query query;
    query.machine = spear(LegSpring::switched);
    query.task.clearance_m = 0.075;
    query.fourier = with_parameters;
    query.starts = 1;
    return *find_gait(query).gait;
  };
  static const Gait parameters = find(true), free = find(false);
  return fourier ? parameters : free;
}

/// With these steps the state at the stride's end is right to 1e-9 (docs/studies.md).
template <class Law>
void stride(benchmark::State& state, const Machine& machine, const Law& law, const Apex<double>& apex,
            double stance_step_s, bool energies) {
  StrideOptions options;
  options.longest_step_s = 4e-3;
  options.stance_step_s = stance_step_s;
  options.energies = energies;
  for (auto _ : state) benchmark::DoNotOptimize(run_stride<double>(machine, law, law, apex, options).apex);
}
void of_parameters(benchmark::State& state, bool energies) {
  const Gait& gait = hop(true);
  const FourierGait& motion = std::get<FourierGait>(gait.motion);
  stride(state, gait.machine, FourierLaw<double>(motion.law), motion.apex, 12e-3, energies);
}
void of_free_torques(benchmark::State& state, bool energies) {
  const Gait& gait = hop(false);
  const FreeLaw law(gait.machine, std::get<FreeGait>(gait.motion));
  stride(state, gait.machine, law, law.apex(), 8e-3, energies);
}
void planar_leg_stride(benchmark::State& state) {
  state.SetLabel("a planar leg's stride with events, 49 parameters, its end right to 1e-9");
  of_parameters(state, false);
}
void planar_leg_stride_with_energies(benchmark::State& state) {
  state.SetLabel("the same with its energies");
  of_parameters(state, true);
}
void planar_leg_free_stride(benchmark::State& state) {
  state.SetLabel("a planar leg's stride with events, free torques, its end right to 1e-9");
  of_free_torques(state, false);
}
void planar_leg_free_stride_with_energies(benchmark::State& state) {
  state.SetLabel("the same with its energies");
  of_free_torques(state, true);
}
BENCHMARK(planar_leg_stride);
BENCHMARK(planar_leg_stride_with_energies);
BENCHMARK(planar_leg_free_stride);
BENCHMARK(planar_leg_free_stride_with_energies);

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
