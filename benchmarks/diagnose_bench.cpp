// How long an identification and a diagnosis take on two threads, and how much faster than one that is.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "host/diagnose/diagnose.hpp"
#include "host/identify/identification.hpp"
#include "host/sim/simulate.hpp"

namespace {

using namespace furcula;

// The example of 002 section 3.2.1, all dampings free.
model::Model example() {
  model::Model model;
  model.kind = dynamics::kKindOf<dynamics::machines::HopperLinear>;
  model.parameters = {1.5, 600.0, 0.28190778623577246, 5.0, 1.0, 1.0, 1.0, 0.15, 0.3490658503988659, 9.81};
  model.free[*dynamics::parameter_index(model.kind, "damping_stance_nspm")] = {0.0, 20.0};
  return model;
}

/// Recordings of `hops` hops each of a machine with the rig's sensors; its dampings and torques are not the
/// model's.
std::vector<log::Log> recordings(model::Model truth, int count, int hops) {
  truth.parameters[*dynamics::parameter_index(truth.kind, "damping_stance_nspm")] = 5.6;
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    sim::Scenario scenario = sim::default_scenario(truth);
    scenario.start_position = 0.33 + 0.002 * i;
    scenario.duration_s = 0.48 * hops;
    scenario.amplitude = 2.0 + 0.05 * i;
    scenario.period_s = 0.27 + 0.006 * i;
    scenario.sensors = {.quantisation = true, .noise = true, .bounce = true, .jitter = true};
    logs.push_back(sim::simulate(truth, scenario, static_cast<std::uint64_t>(i)));
  }
  return logs;
}

/// Mass and damping from 60 stance phases, 10 folds, by both estimators.
void identify_60_stances(benchmark::State& state) {
  state.SetLabel("mass and damping from 60 stances, 10 folds, both estimators");
  model::Model model = example();
  model.free[*dynamics::parameter_index(model.kind, "mass_kg")] = {1.0, 2.0};
  const std::vector<log::Log> logs = recordings(model, 10, 6);
  identify::IdentifyOptions options;
  options.by_equation = options.by_simulation = true;
  options.folds = 10;
  options.threads = static_cast<unsigned>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(identify::identify(model, logs, {}, options));
}
BENCHMARK(identify_60_stances)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

/// 12 logs of 8 hops with dry friction, two of them held out.
void diagnose_12_logs(benchmark::State& state) {
  state.SetLabel("a diagnosis of 12 logs of 8 hops");
  const model::Model model = example();
  model::Model truth = model;
  truth.effects[dynamics::Effect::coulomb_friction] = {1.5};
  std::vector<log::Log> logs = recordings(truth, 12, 8);
  const std::vector<log::Log> held_out(logs.end() - 2, logs.end());
  logs.resize(10);
  diagnose::Options options;
  options.threads = static_cast<unsigned>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(diagnose::diagnose(model, logs, held_out, options));
}
BENCHMARK(diagnose_12_logs)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
