#include "host/machines/axis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/message.hpp"

namespace furcula::machines {

using control::ProfileShape;
using core::rounded;

Run usual_run_of_axis(const model::Model&) {
  Run run;
  run.amplitude = 1.0;
  run.period_s = 1.0;
  return run;
}

void experiments_of_axis(ExperimentLibrary& experiment_library, const model::Model& model,
                         const Reach& reach) {
  const bool rotary = dynamics::info(model.kind).rotary;
  // A rig that has only coasted or swung: as much as makes a second's motion as fast as that.
  const double most =
      reach.input == 0.0 ? 2.0 * std::numbers::pi * model.parameters.front() * reach.speed : reach.input;
  const char* unit = rotary ? " N m" : " N";
  const char* input = rotary ? "torque" : "force";
  for (double share : {0.25, 0.5, 1.0})
    for (double period_s : {0.25, 0.5, 1.0, 2.0, 4.0}) {
      const double amplitude = share * most;
      // Begun at the speed about which a sine of force makes a sine of position.
      const double velocity =
          rotary ? 0.0 : -amplitude * period_s / (2.0 * std::numbers::pi * model.parameters.front());
      experiment_library.add(
          "a harmonic " + std::string(input) + " of " + rounded(amplitude, 3) + unit + " and " +
              rounded(period_s, 3) + " s",
          ExperimentLibrary::driven(experiment_library.start(0.0, velocity, std::max(4.0, 3.0 * period_s)),
                                    ProfileShape::harmonic, amplitude, period_s));
    }
  if (rotary) {
    for (double share : {0.25, 0.5, 1.0}) {
      const double angle = share * std::max(std::abs(reach.lowest), std::abs(reach.highest));
      experiment_library.add("a swing without torque, let go at " + rounded(angle, 3) + " rad",
                             experiment_library.start(angle, 0.0, 6.0));
    }
  } else {
    for (double share : {0.3, 1.0})
      for (double sign : {1.0, -1.0})
        experiment_library.add(
            "coasting to rest from " + rounded(share * sign * reach.speed, 3) + " m/s without force",
            experiment_library.start(0.0, share * sign * reach.speed, 2.0));
  }
  experiment_library.add(
      "a long run for drift: 60 s of a harmonic " + std::string(input) + " of " + rounded(most, 3) + unit +
          " and 1 s",
      ExperimentLibrary::driven(
          experiment_library.start(
              0.0, rotary ? 0.0 : -most / (2.0 * std::numbers::pi * model.parameters.front()), 60.0),
          ProfileShape::harmonic, most, 1.0));
}

}  // namespace furcula::machines
