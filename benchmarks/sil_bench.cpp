// How fast the controller, and a second of the whole simulated stack, run on the host.
#include <benchmark/benchmark.h>

#include "furcula/control/controller.hpp"
#include "host/sim/simulate.hpp"

namespace {

using namespace furcula;

// The example of 002 section 3.2.1.
model::Model example() {
  model::Model model;
  model.kind = dynamics::kKindOf<dynamics::machines::HopperLinear>;
  model.parameters = {1.5, 600.0, 0.28190778623577246, 5.0, 1.0, 1.0, 1.0, 0.15, 0.3490658503988659, 9.81};
  return model;
}

sim::Scenario hopping(double duration_s, bool real_sensors) {
  sim::Scenario scenario;
  scenario.start_position = 0.35;
  scenario.duration_s = duration_s;
  scenario.amplitude = 2.0;
  scenario.period_s = 0.3;
  if (real_sensors) scenario.sensors = {true, true, true, true};
  return scenario;
}

/// One step of the controller on samples of a second of hopping.
void controller_step(benchmark::State& state) {
  const sim::Scenario scenario = hopping(1.0, true);
  const control::Config config = sim::controller_config(example(), scenario);
  sim_host::SimBoard board(sim::rig_config(example(), scenario, 1));
  firmware::App app(board, config);
  std::vector<control::Inputs> inputs;
  while (board.wait_for_tick()) {
    app.tick();
    inputs.push_back({.sample = board.sample(), .sample_valid = true, .tick_interval_us = 1000});
  }
  state.SetLabel("one step of the controller, on samples of a hopping robot");
  control::State controller = control::begin(config);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(control::step(config, controller, inputs[i], 0.001f));
    if (++i < inputs.size()) continue;
    // From the start again: what jumps back would be a fault, and a robot in its safe state is another thing.
    i = 0;
    controller = control::begin(config);
  }
}
BENCHMARK(controller_step);

/// Ten seconds of application, controller, sensors and plant, and of the log. Counter: seconds simulated in
/// one.
void sil(benchmark::State& state) {
  state.SetLabel(state.range(0) != 0 ? "10 s of hopping in SIL; encoder and switch with their errors"
                                     : "10 s of hopping in SIL; ideal sensors");
  const sim::Scenario scenario = hopping(10.0, state.range(0) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(sim::simulate(example(), scenario, 1));
  state.counters["times_real_time"] =
      benchmark::Counter(10.0 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(sil)->ArgName("real_sensors")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// The robot of 002 chapter 5 (links of table 3.1, modular clutch).
model::Model robot_with_clutch() {
  model::Model model = example();
  model.kind = dynamics::kKindOf<dynamics::machines::HopperNonlinear>;
  model.parameters[2] = 0.289;
  for (const double inertia : {42e-4, 75e-4, 38e-3}) model.parameters.push_back(inertia);
  model.clutch = model::Clutch{0.020, 0.020, 20.0, 3e-3 / 0.7};
  return model;
}

/// A minute of the whole machine at its worst: spring let go and leg folded by 5 cm in each flight, rough
/// sensors, steps of 3 cm in the ground, a coil that sticks, is dead or short of voltage every ten seconds.
void sil_clutch(benchmark::State& state) {
  constexpr double kDuration_s = 60.0;
  state.SetLabel(
      "60 s in SIL: clutch released in each flight, leg folds, rough sensors and ground, coil fails");
  sim::Scenario scenario = hopping(kDuration_s, true);
  scenario.amplitude = 3.0;
  scenario.release_in_flight = true;
  scenario.contraction_m = 0.05;
  scenario.ground_steps_m = 0.03;
  using sim_host::RigFault;
  const RigFault kinds[] = {RigFault::coil_stuck_on, RigFault::coil_open, RigFault::supply_sag};
  for (std::size_t i = 0; i < 6; ++i)
    scenario.faults.push_back({5.0 + 10.0 * static_cast<double>(i), kinds[i % 3], 0.3});
  for (auto _ : state) {
    const log::Log log = sim::simulate(robot_with_clutch(), scenario, 1);
    if (log.at("fault").back() != 0.0) return state.SkipWithError("the robot came to a fault");
  }
  state.counters["times_real_time"] =
      benchmark::Counter(kDuration_s * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(sil_clutch)->Name("sil/clutch")->Unit(benchmark::kMillisecond);

}  // namespace
