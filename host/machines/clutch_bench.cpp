// The release/catch bench: a weight on a belt that a clutch holds and lets go.
#include "boards/sim_host/sensors.hpp"
#include "host/core/message.hpp"
#include "host/machines/rules.hpp"

namespace furcula::machines {
namespace {

Run usual_run(const model::Model&) {
  Run run;
  run.duration_s = 0.5;
  run.profile = control::ProfileShape::zero;
  run.clutch = {{0.1, true}, {0.14, false}};
  return run;
}

void experiments(ExperimentLibrary& experiment_library, const model::Model& model, const Reach&) {
  const double delay_s = model.parameter("release_delay_s");
  for (double fall_s : {0.02, 0.03, 0.045}) {
    Run run = experiment_library.start(0.0, 0.0, 0.0);
    run.clutch.clear();
    constexpr int kReleases = 5;
    for (int i = 0; i < kReleases; ++i) {
      const double at_s = 0.1 + 0.4 * i;
      run.clutch.push_back({at_s, true});
      run.clutch.push_back({at_s + delay_s + fall_s + 1e-3 * i, false});
    }
    run.duration_s = 0.1 + 0.4 * kReleases;
    experiment_library.add("five releases one after the other, each with a fall of " +
                               core::rounded(1e3 * fall_s, 3) + " ms and more",
                           run);
  }
}

constexpr Rules kRules{
    .channel = "angle",
    .columns = {.position = "pulley_angle_rad", .input = "solenoid"},
    .keys = {.position = "angle_rad", .position_unit = "rad", .position_least = -1e3, .position_most = 1e3},
    .count = sim_host::kPulleyCountRad,
    .cut = Cut::releases,
    .usual_run = usual_run,
    .experiments = experiments,
    .inertia =
        [](const model::Model& m) {
          const double radius_m = m.parameter("pulley_radius_m");
          return m.parameter("load_mass_kg") * radius_m * radius_m + m.parameter("pulley_inertia_kgm2");
        },
    .weight =
        [](const model::Model& m) {
          return m.parameter("load_mass_kg") * dynamics::kBenchGravity_mps2 * m.parameter("pulley_radius_m");
        },
    .held = true,
    .fit_expects = "a release (solenoid = 1) from a rest of three rows, and 30 ms after its end",
    .window_expected =
        [](const model::Model&) {
          return std::string(
              "release: expected solenoid = 1 for a while, at least three rows of rest before "
              "and 30 ms after it");
        },
};

}  // namespace
}  // namespace furcula::machines

const furcula::machines::Rules& furcula::dynamics::machines::ClutchBench::rules() {
  return furcula::machines::kRules;
}
