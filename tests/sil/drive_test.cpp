// The simulated drive against closed forms, one command after the other, and over long runs, in which it forgets.
#include <malloc.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "boards/sim_host/live_commands.hpp"
#include "host/sim/live_rig.hpp"

namespace {

using furcula::dynamics::Effect;
using furcula::dynamics::Effects;
using furcula::sim_host::LiveCommands;

constexpr double kStep_s = 0.001;

/// An actuation that is told its commands one after the other.
class Drive {
 public:
  explicit Drive(const Effects<double>& effects)
      : actuation_{furcula::dynamics::Drive<double>(effects), furcula::dynamics::Motor<double>(effects)} {}
  double shows(double command, double step_s) { return commands_.shown(actuation_, command, step_s); }
  double step(double command, double step_s) { return commands_.torque(actuation_, command, step_s); }
  std::size_t kept() const { return commands_.kept(); }

 private:
  furcula::dynamics::Actuation<double> actuation_;
  LiveCommands commands_;
};

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

double command_at(int tick) { return std::sin(0.05 * tick) + 0.3 * std::sin(1.7 * tick); }

TEST_CASE("a drive keeps as many commands as its delay needs, however long it runs") {
  for (const double delay_s : {0.0, 0.003, 1.5}) {
    Effects<double> effects;
    if (delay_s > 0.0) effects.set(Effect::actuator_delay, {delay_s});
    Drive drive(effects);
    const int delay_ticks = static_cast<int>(std::lround(delay_s / kStep_s));
    double worst = 0.0;
    std::size_t most = 0;
    for (int tick = 0; tick < 50'000; ++tick) {
      const double torque_nm = drive.step(command_at(tick), kStep_s);
      most = std::max(most, drive.kept());
      // A delay of whole steps gives the command of so many steps before.
      if (tick > delay_ticks + 1)
        worst = std::max(worst, std::abs(torque_nm - command_at(tick - delay_ticks)));
    }
    INFO(delay_s << " s");
    CHECK(worst < 1e-6);
    CHECK(most <= 2 * static_cast<std::size_t>(delay_ticks) + 2048);
  }
}

#ifndef __SANITIZE_ADDRESS__
TEST_CASE("a robot that is served takes no more memory the longer it runs") {
  furcula::sim::LiveRig rig(furcula::sim::example_hopper(),
                            furcula::sim::default_scenario(furcula::sim::example_hopper()), 1, "", {}, 7);
  rig.advance(10'000);
  const std::size_t before = ::mallinfo2().uordblks;
  rig.advance(100'000);
  // 32 bytes a tick were 3.2 MB.
  CHECK(::mallinfo2().uordblks < before + 1024);
}
#endif

}  // namespace
