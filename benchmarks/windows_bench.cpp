// Windows of a walking robot's recording: derivatives by all unknowns, and the fit of the windows' own ones.
#include <benchmark/benchmark.h>

#include <vector>

#include "furcula/dynamics/biped/design.hpp"
#include "host/floating/likelihood.hpp"
#include "host/walk/simulation.hpp"

namespace {

using namespace furcula;
using namespace furcula::floating;

constexpr std::size_t kWindows = 12;

struct Standing {
  Machine machine;
  std::vector<Recording> recordings;
  std::vector<Window> windows;
  std::vector<Unknown> unknowns;

  Standing() {
    machine.robot = dynamics::biped::design();
    std::array<double, walk::Parameters::kCount> values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = control::kWalkParameters[i].start;
    walk::Parameters stands = walk::Parameters::of(values);
    stands.start_s = 1e3;
    stands.sway_rad = 0.0;
    log::Log log = walk::simulate_walk(machine.robot, {}, stands, 0.01, 1).log;
    log.path = "standing.csv";
    recordings.push_back(recording_of(log));
    windows = windows_of(recordings[0], 0, 0.4);
    windows.resize(kWindows);
    unknowns = biped::unknowns(machine.robot, true, false);
  }
  Point point() const {
    return {machine, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns.size())),
            std::vector<Local>(windows.size(), Local::Zero())};
  }
  Settings settings{1e-3, 1};
};

void windows_linearised(benchmark::State& state) {
  const Standing of;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        linearised(of.recordings, of.windows, first_variances(), of.unknowns, of.point(), of.settings));
  state.SetLabel("12 windows of 0.4 s, both feet on the ground: derivatives by all unknowns; items: windows");
  state.SetItemsProcessed(static_cast<std::int64_t>(kWindows * state.iterations()));
}

void windows_fitted(benchmark::State& state) {
  const Standing of;
  for (auto _ : state) {
    Point p = of.point();
    benchmark::DoNotOptimize(fit_locals(of.recordings, of.windows, first_variances(), p, of.settings));
  }
  state.SetLabel("the same windows: their own unknowns are fitted");
  state.SetItemsProcessed(static_cast<std::int64_t>(kWindows * state.iterations()));
}
BENCHMARK(windows_linearised)->Unit(benchmark::kMillisecond);
BENCHMARK(windows_fitted)->Unit(benchmark::kMillisecond);

}  // namespace
