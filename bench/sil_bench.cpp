// How fast the controller, and a second of the whole simulated stack, run on the host.
#include <benchmark/benchmark.h>

#include "furcula/control/controller.hpp"
#include "host/sim/simulate.hpp"

namespace {

using namespace furcula;

// The example of 002 section 3.2.1.
model::Model example() {
  model::Model model;
  model.kind = dynamics::Kind::hopper_linear;
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
    inputs.push_back({board.sample(), true, false, 1000});
  }
  control::State controller = control::begin(config);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(control::step(config, controller, inputs[i], 0.001f));
    i = i + 1 == inputs.size() ? 0 : i + 1;
  }
}
BENCHMARK(controller_step);

/// Ten seconds of application, controller, sensors and plant, and of the log. Counter: seconds simulated in
/// one.
void sil(benchmark::State& state) {
  const sim::Scenario scenario = hopping(10.0, state.range(0) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(sim::simulate(example(), scenario, 1));
  state.counters["times_real_time"] =
      benchmark::Counter(10.0 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(sil)->ArgName("real_sensors")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
