// A carriage on a vertical rail, thrown up from its stop or let fall.
#include <algorithm>
#include <cmath>

#include "boards/sim_host/sensors.hpp"
#include "host/core/message.hpp"
#include "host/machines/rules.hpp"

namespace furcula::machines {
namespace {

using core::rounded;

Run usual_run(const model::Model&) {
  Run run;
  run.start_position = 1.0;
  run.duration_s = 1.0;
  run.profile = control::ProfileShape::zero;
  return run;
}

void experiments(ExperimentLibrary& experiment_library, const model::Model&, const Reach& reach) {
  const double highest = std::max(reach.highest, 0.05);
  for (double share : {0.5, 1.0, 2.0})
    experiment_library.add("a fall from " + rounded(share * highest, 3) + " m",
                           experiment_library.start(share * highest, 0.0, 0.5 + std::sqrt(share * highest)));
  for (double share : {0.5, 1.0, 1.5}) {
    const double speed = std::sqrt(2.0 * 9.81 * share * highest);
    experiment_library.add("a flight pushed up from the stop at " + rounded(speed, 3) + " m/s",
                           experiment_library.start(0.0, speed, 0.5 + speed / 4.0));
  }
}

constexpr Rules kRules{
    .channel = "height",
    .columns = {.position = "height_m", .velocity = "velocity_mps", .stop = "contact"},
    .keys = {.position = "height_m",
             .position_unit = "m",
             .position_least = 0.0,  // on its stop
             .position_most = 100.0,
             .velocity = "velocity_mps",
             .velocity_unit = "m/s",
             .velocity_most = 50.0},
    .count = sim_host::kHeightCountM,
    .cut = Cut::flights,
    .usual_run = usual_run,
    .experiments = experiments,
    .fit_expects = "a flight of at least 30 ms, six rows or more without contact",
    .window_expected =
        [](const model::Model&) {
          return std::string("free flight: expected at least 30 ms and six rows in a row without contact");
        },
};

}  // namespace
}  // namespace furcula::machines

const furcula::machines::Rules& furcula::dynamics::machines::RailCarriage::rules() {
  return furcula::machines::kRules;
}
