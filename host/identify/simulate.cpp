// Runs in plain numbers, and what is asked of a model without a run.
#include "host/identify/simulate.hpp"

#include "host/identify/simulate_impl.hpp"
#include "host/identify/window_run_impl.hpp"

namespace furcula::identify {

template void simulate(const PlantSetup<double>&, const Recording&, const Window&, const double&,
                       const double&, const VisitRow<double>&);
template void one_step_each(const PlantSetup<double>&, const Recording&, const Window&,
                            const VisitStep<double>&);
template double report_lag(const PlantSetup<double>&, const Recording&, const Window&, double);
template bool run_window<double>(const WindowRun&, double const* const*, double*, double**);

std::vector<double> inputs(const PlantSetup<double>& setup, const Recording& r) {
  std::vector<double> all;
  const dynamics::Commands<double> commands = r.commands();
  detail::with_stages(setup, r, [&](auto& stages) {
    stages.actuation().drive.start(commands, 0);
    for (std::size_t i = 0; i + 1 < r.rows(); ++i)
      all.push_back(stages.actuation().torque(commands, i, r.time_s[i + 1] - r.time_s[i]));
  });
  return all;
}

double acceleration(const PlantSetup<double>& setup, const Recording& r, double position, double velocity,
                    double input, double probe_s, std::optional<std::size_t> row) {
  double result = 0.0;
  detail::with_stages(setup, r, [&](auto& stages) {
    auto& plant = stages.plant();
    const double off = row ? detail::slipped(stages.sensing(), r, *row) : 0.0;
    const auto start = stages.behind(position - off, velocity);
    if constexpr (requires { plant.reset_loose(start.position, start.velocity); })
      plant.reset_loose(start.position, start.velocity);  // a held belt has no acceleration
    else
      plant.reset(start.position, start.velocity);
    if (row) detail::LeggedRecording<double>{r, stages.sensing().skew_s()}.start(plant, *row);
    plant.advance(input, probe_s);
    result = (stages.velocity() - velocity) / probe_s;
  });
  return result;
}

}  // namespace furcula::identify
