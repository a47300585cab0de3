// Faults in the simulated rig: the safe state within two ticks, latched until a reset.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "furcula/control/fault.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;
using sim_host::RigFault;

namespace {

/// When in the hopping of the example, after one second, the body is this far into a stance or a flight.
double instant(bool stance, double after_s) {
  const log::Log log = sim::simulate(example_hopper(), example_scenario(5.0), 1);
  const auto& contact = log.at("contact");
  for (std::size_t row = 1000; row < log.rows(); ++row)
    if ((contact[row] == 1.0) == stance && (contact[row - 1] == 1.0) != stance)
      return log.time_s()[row] + after_s;
  FAIL("no such instant");
  return 0.0;
}

log::Log with_fault(RigFault kind, double time_s, double duration_s = 100.0) {
  auto scenario = example_scenario(5.0);
  scenario.faults = {{time_s, kind, duration_s}};
  return sim::simulate(example_hopper(), scenario, 1);
}

/// First row's time at which the controller is in the fault, or -1.
double time_of(control::Fault fault, const log::Log& log) {
  for (std::size_t row = 0; row < log.rows(); ++row)
    if (log.at("fault")[row] == static_cast<double>(fault)) return log.time_s()[row];
  return -1.0;
}

/// The largest torque commanded from this time on; and the solenoid.
double most_torque_from(double time_s, const log::Log& log) {
  double most = 0.0;
  for (std::size_t row = 0; row < log.rows(); ++row)
    if (log.time_s()[row] >= time_s - 1e-9) most = std::max(most, std::abs(log.at("torque_cmd_nm")[row]));
  return most;
}

}  // namespace

TEST_CASE("torque is zero within two ticks of a frozen encoder, a lost height or a lost peer") {
  struct Case {
    RigFault kind;
    control::Fault fault;
  };
  const Case c = GENERATE(Case{RigFault::encoder_frozen, control::Fault::stale_input},
                          Case{RigFault::height_nan, control::Fault::non_finite_input},
                          Case{RigFault::peer_lost, control::Fault::peer_lost});
  const double t = instant(true, 0.040);
  // Rows without a height are left out of the log: look at the board itself.
  auto scenario = example_scenario(5.0);
  scenario.faults = {{t, c.kind, 100.0}};
  sim_host::SimBoard board(sim::rig_config(example_hopper(), scenario, 1));
  firmware::App app(board, sim::controller_config(example_hopper(), scenario));
  double before_nm = 0.0;
  INFO("fault " << static_cast<int>(c.kind) << " at " << t);
  while (board.wait_for_tick()) {
    app.tick();
    if (board.time_s() < t - 1e-9) {
      before_nm = static_cast<double>(board.command().torque_nm);
    } else if (board.time_s() > t + 0.0015) {
      REQUIRE(board.command().torque_nm == 0.0f);
      REQUIRE(board.command().coil_duty == 0.0f);
    }
  }
  CHECK(before_nm > 1.0);  // the fault met a working motor
  CHECK(board.telemetry().outputs.fault == c.fault);
}

TEST_CASE("a tick that comes 5 ms late finds the torque zero on the very tick") {
  const double t = instant(true, 0.040);
  const log::Log log = with_fault(RigFault::late_tick, t, 0.005);
  CHECK(time_of(control::Fault::late_tick, log) == Approx(t + 0.005).margin(1e-9));
  CHECK(most_torque_from(t + 0.005, log) == 0.0);
}

TEST_CASE(
    "while a tick is late by more than the watchdog's 5 ms the drive is off before the controller comes back") {
  const double t = instant(true, 0.020);
  auto scenario = example_scenario(5.0);
  scenario.faults = {{t, RigFault::late_tick, 0.050}};
  sim_host::SimBoard board(sim::rig_config(example_hopper(), scenario, 1));
  firmware::App app(board, sim::controller_config(example_hopper(), scenario));
  while (board.wait_for_tick()) {
    if (board.time_s() > t + 0.010) {
      CHECK(board.command().torque_nm == 0.0f);  // before the controller's first tick after the gap
      break;
    }
    app.tick();
  }
  CHECK(board.time_s() == Approx(t + 0.050).margin(1e-9));
}

TEST_CASE("a switch that sticks closed in flight never brings torque again that moves the leg") {
  const double t = instant(false, 0.060);
  const log::Log log = with_fault(RigFault::switch_stuck_closed, t);
  // It lands with a brake, which knows the rate of a millisecond ago.
  const auto &torque = log.at("torque_cmd_nm"), &angle = log.at("leg_angle_rad");
  double most_power_w = -1.0;
  for (std::size_t row = 0; row + 1 < log.rows(); ++row)
    if (log.time_s()[row] >= t - 1e-9)
      most_power_w = std::max(most_power_w, torque[row] * (angle[row + 1] - angle[row]) / 1e-3);
  CHECK(most_power_w < 0.2);
  const double landed_s = time_of(control::Fault::contact_switch_lost, log);
  CHECK(landed_s > t + 0.1);
  CHECK(landed_s < t + 1.0);
  CHECK(most_torque_from(landed_s, log) == 0.0);
}

TEST_CASE("a height counter that stands still in stance is noticed before the leg has moved 4 cm") {
  const double t = instant(true, 0.005);
  const log::Log log = with_fault(RigFault::encoder_stuck, t);
  const double noticed_s = time_of(control::Fault::encoder_implausible, log);
  REQUIRE(noticed_s > t);
  const auto row = [&](double time_s) { return static_cast<std::size_t>(std::lround(time_s * 1e3)); };
  const auto leg_m = [&](double time_s) { return 0.3 * std::cos(log.at("leg_angle_rad")[row(time_s)]); };
  CHECK(leg_m(t) - leg_m(noticed_s) == Approx(0.035).margin(0.002));
  CHECK(most_torque_from(noticed_s, log) == 0.0);
}

TEST_CASE("after a fault has gone the safe state stays until a reset, and then the robot hops again") {
  const double t = instant(true, 0.040);
  auto scenario = example_scenario(20.0);
  scenario.faults = {{t, RigFault::peer_lost, 0.1}};
  sim_host::SimBoard board(sim::rig_config(example_hopper(), scenario, 1));
  firmware::App app(board, sim::controller_config(example_hopper(), scenario));
  double highest_before_reset_m = 0.0, highest_at_end_m = 0.0;
  while (board.wait_for_tick()) {
    if (std::abs(board.time_s() - 8.0) < 1e-9) board.request_reset();
    app.tick();
    if (board.time_s() > t + 0.2 && board.time_s() < 8.0) {
      REQUIRE(board.telemetry().outputs.fault == control::Fault::peer_lost);
      REQUIRE(board.command().torque_nm == 0.0f);
    }
    if (board.time_s() > 7.0 && board.time_s() < 8.0)
      highest_before_reset_m = std::max(highest_before_reset_m, board.plant().height_m());
    if (board.time_s() > 19.0) highest_at_end_m = std::max(highest_at_end_m, board.plant().height_m());
  }
  CHECK(highest_before_reset_m < kTouchdownM);  // come to rest
  CHECK(board.telemetry().outputs.fault == control::Fault::none);
  CHECK(highest_at_end_m == Approx(0.361).margin(0.001));
}

TEST_CASE("rows without a height are left out of the log, time goes on over the gap") {
  const log::Log log = with_fault(RigFault::height_nan, 1.0, 0.25);
  CHECK(log.rows() == 4750);
  for (std::size_t row = 0; row < log.rows(); ++row) REQUIRE(std::isfinite(log.at("height_m")[row]));
  CHECK(log.time_s()[999] == Approx(0.999));
  CHECK(log.time_s()[1000] == Approx(1.25));
}

TEST_CASE("a scenario with a fault of the drive puts it behind a bus, and the robot hops there as well") {
  const double t = 3.0;
  const log::Log log = with_fault(RigFault::drive_silent, t);
  const auto hops = apexes(log);
  REQUIRE(hops.size() > 4);
  CHECK(hops[4] == Approx(0.36).margin(0.005));
  const double noticed_s = time_of(control::Fault::drive_silent, log);
  CHECK(noticed_s - t > 0.0);
  CHECK(noticed_s - t < 0.0035);
  CHECK(most_torque_from(t + 0.001, log) == 0.0);  // a dead drive gives none
}
