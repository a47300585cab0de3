// The simulated drive against closed forms, one command after the other.
#include "boards/sim_host/drive.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace {

using furcula::dynamics::Effect;
using furcula::dynamics::Effects;
using furcula::sim_host::Drive;

constexpr double kStep_s = 0.001;

Drive drive_with(Effect effect, double first, double second = 0.0) {
  Effects<double> effects;
  effects.set(effect, {first, second});
  return Drive(effects);
}

TEST_CASE("a motor that gets warm loses torque over the time in which it was driven, not over pauses") {
  const double final_gain = 0.6, time_constant_s = 2.0;
  Drive drive = drive_with(Effect::thermal_derating, final_gain, time_constant_s);
  double driven_s = 0.0;
  for (int n = 0; n < 4000; ++n) {
    const double command_nm = n < 1500 || n >= 2500 ? 2.0 : 0.0;
    const double gain = final_gain + (1.0 - final_gain) * std::exp(-driven_s / time_constant_s);
    REQUIRE(drive.step(command_nm, kStep_s) == Approx(command_nm * gain).epsilon(1e-12));
    if (command_nm != 0.0) driven_s += kStep_s;
  }
}

TEST_CASE("a drive that lags follows a step of its command as 1 - exp(-t / tau), meant over each step") {
  const double tau_s = 0.004;
  Drive drive = drive_with(Effect::actuator_lag, tau_s);
  REQUIRE(drive.step(0.0, kStep_s) == 0.0);
  for (int n = 0; n < 30; ++n) {
    const double start = std::exp(-n * kStep_s / tau_s), end = std::exp(-(n + 1) * kStep_s / tau_s);
    REQUIRE(drive.step(1.0, kStep_s) == Approx(1.0 - (start - end) * tau_s / kStep_s).epsilon(1e-12));
  }
}

TEST_CASE("a drive that is 2.5 ms late gives a command's first half after two steps, and shows it") {
  Drive drive = drive_with(Effect::actuator_delay, 0.0025);
  for (int n = 0; n < 5; ++n) drive.step(0.0, kStep_s);
  const double expected[] = {0.0, 0.0, 0.5, 1.0, 1.0};
  for (const double mean : expected) {
    drive.shows(1.0, kStep_s);  // what the current shows is asked for before the step, of the same command
    REQUIRE(drive.step(1.0, kStep_s) == Approx(mean).margin(1e-9));
  }
}

TEST_CASE("an ideal drive shows and gives each command at once") {
  Drive drive{Effects<double>{}};
  for (int n = 0; n < 100; ++n) {
    const double command_nm = 0.1 * (n % 7) - 0.3;
    REQUIRE(drive.shows(command_nm, kStep_s) == command_nm);
    REQUIRE(drive.step(command_nm, kStep_s) == command_nm);
  }
}

}  // namespace
