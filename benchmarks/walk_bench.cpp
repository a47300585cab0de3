// Walks in lanes as a search runs them: controller, filter, contact, limits and energy, with lanes filled again as robots fall.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/search.hpp"

namespace {

using namespace furcula;

/// About where searches start: most fall.
std::vector<walk::Parameters> walks() {
  std::vector<walk::Parameters> out;
  for (std::size_t k = 0; k < 32; ++k) {
    std::array<double, walk::Parameters::kCount> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& p = control::kWalkParameters[i];
      const double share = 0.15 * std::sin(2.3 * static_cast<double>(i) + 1.1 * static_cast<double>(k * k));
      values[i] = std::fmin(p.most, std::fmax(p.least, p.start + share * (p.most - p.least)));
    }
    out.push_back(walk::Parameters::of(values));
  }
  return out;
}

void rollouts(benchmark::State& state, walk::WalkMode mode) {
  const auto robot = dynamics::biped::design();
  const auto all = walks();
  walk::RolloutOptions options;
  options.mode = mode;
  std::uint64_t steps = 0;
  for (auto _ : state)
    for (const walk::Rollout& r : walk::run_walks(robot, options, all, 1)) steps += r.steps;
  state.SetLabel(mode == walk::WalkMode::active
                     ? "32 walks of the biped in lanes, most of which fall; items: steps of one robot"
                     : "the same with passive hips");
  state.SetItemsProcessed(static_cast<std::int64_t>(steps));
}
void walks_in_lanes(benchmark::State& state) { rollouts(state, walk::WalkMode::active); }
void semi_passive_walks_in_lanes(benchmark::State& state) { rollouts(state, walk::WalkMode::semi_passive); }
BENCHMARK(walks_in_lanes)->Unit(benchmark::kMillisecond);
BENCHMARK(semi_passive_walks_in_lanes)->Unit(benchmark::kMillisecond);

}  // namespace
