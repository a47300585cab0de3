// Faults that the signals do not tell, or not at once: what bounds them (docs/safety.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "boards/sim_host/can_board.hpp"
#include "firmware/app/app.hpp"
#include "furcula/control/fault.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;
using control::Fault;
using sim_host::CanBoard;
using sim_host::RigFault;

namespace {

struct Outcome {
  Fault fault = Fault::none;
  double found_s = 0.0;  ///< after the fault began
  double highest_m = 0.0, last_apex_m = 0.0;
  double hardest_mps = 0.0, toe_mps = 0.0;  ///< at touch-downs
  double lowest_m = 1.0;                    ///< until something was found
  int hops = 0;
};

/// The clutched robot behind a bus with every error of its sensors; `size` sets how large the fault is.
template <class Size>
Outcome hop_with(RigFault kind, double from_s, double duration_s, sim::Scenario scenario, const Size& size) {
  scenario.duration_s = duration_s;
  scenario.sensors = {true, true, true, true};
  scenario.faults = {{from_s, kind, 1e6}};
  sim_host::RigConfig rig_config = sim::rig_config(robot_with_clutch(), scenario, 1);
  size(rig_config);
  CanBoard board(rig_config);
  control::Config config = sim::controller_config(robot_with_clutch(), scenario);
  CanBoard::adapt(config);
  firmware::App app(board, config);
  Outcome out;
  bool stood = false;
  double body_mps = 0.0, toe_mps = 0.0;
  while (board.wait_for_tick()) {
    app.tick();
    const auto& plant = board.rig().plant();
    out.highest_m = std::max(out.highest_m, plant.height_m());
    if (board.rig().time_s() > duration_s - 2.0)
      out.last_apex_m = std::max(out.last_apex_m, plant.height_m());
    if (out.fault == Fault::none) out.lowest_m = std::min(out.lowest_m, plant.height_m());
    if (plant.in_stance() && !stood) {
      ++out.hops;
      out.hardest_mps = std::max(out.hardest_mps, -body_mps);
      out.toe_mps = std::max(out.toe_mps, -toe_mps);
    }
    stood = plant.in_stance();
    body_mps = plant.velocity_mps();
    toe_mps = plant.toe_velocity_mps();
    const Fault now = app.telemetry().outputs.fault;
    if (out.fault == Fault::none && now != Fault::none) {
      out.fault = now;
      out.found_s = board.rig().time_s() - from_s;
    }
  }
  return out;
}

/// The limits of docs/safety.md.
void check_safe(const Outcome& out) {
  CHECK(out.highest_m < 0.75);
  CHECK(out.hardest_mps < 3.0);
  CHECK(out.toe_mps < 4.0);
  CHECK(out.lowest_m > 0.10);
}

}  // namespace

TEST_CASE("a height that drifts is found at 3.5 cm, however slowly, and the robot hops safely until then") {
  const double drift_mps = GENERATE(-0.05, -0.01, -0.002, 0.002, 0.01, 0.05);
  const Outcome out = hop_with(RigFault::encoder_drifting, 1.5, 25.0, clutch_scenario(25.0),
                               [&](auto& rig) { rig.drift_mps = drift_mps; });
  INFO(drift_mps << " m/s, found " << control::info(out.fault).name << " after " << out.found_s << " s");
  CHECK((out.fault == Fault::encoder_implausible || out.fault == Fault::contact_implausible));
  // It shows in a stance: a stride is up to 0.5 s, and noise and quantisation are a millimetre.
  const double drifted_m = std::abs(drift_mps) * out.found_s;
  CHECK(drifted_m > 0.033);
  CHECK(drifted_m < 0.036 + 0.5 * std::abs(drift_mps));
  check_safe(out);
}

TEST_CASE("an offset of the torque that the current does not show leaves the hops as they are") {
  const Outcome sound = hop_with(RigFault::torque_offset_hidden, 1.5, 20.0, clutch_scenario(20.0),
                                 [](auto& rig) { rig.torque_offset_nm = 0.0; });
  const double offset_nm = GENERATE(-1.4, -0.6, 0.6, 1.4);
  const Outcome out = hop_with(RigFault::torque_offset_hidden, 1.5, 20.0, clutch_scenario(20.0),
                               [&](auto& rig) { rig.torque_offset_nm = offset_nm; });
  INFO(offset_nm << " N m");
  CHECK(out.fault == Fault::none);
  CHECK(out.last_apex_m == Approx(sound.last_apex_m).margin(0.02));
  check_safe(out);
}

TEST_CASE("an offset that the current shows is found from 0.5 N m on, below the tolerance of one reply") {
  const double offset_nm = GENERATE(-1.2, -0.6, -0.3, 0.3, 0.6, 1.2);
  const Outcome out = hop_with(RigFault::torque_offset, 1.5, 8.0, clutch_scenario(8.0),
                               [&](auto& rig) { rig.torque_offset_nm = offset_nm; });
  INFO(offset_nm << " N m");
  CHECK(out.fault == (std::abs(offset_nm) > 0.5 ? Fault::drive_disobeys : Fault::none));
  // The mean over 0.512 s comes to 0.5 of 1.2 N m after 0.512 ln(1.2 / 0.7) = 0.276 s.
  if (std::abs(offset_nm) > 1.0) CHECK(out.found_s == Approx(0.276).margin(0.01));
  check_safe(out);
}

TEST_CASE(
    "a motor that turns the wrong way is found when the leg is moved in flight, and brakes where it is not") {
  sim::Scenario high = clutch_scenario(8.0);
  high.start_position = 0.45;  // so that the first hop after the landing is one
  const Outcome moved = hop_with(RigFault::drive_reversed, 0.001, 8.0, high, [](auto&) {});
  CHECK(moved.fault == Fault::leg_astray);
  check_safe(moved);
  sim::Scenario still = clutch_scenario(8.0);
  still.release_in_flight = false;
  still.contraction_m = 0.0;
  const Outcome unmoved = hop_with(RigFault::drive_reversed, 0.001, 8.0, still, [](auto&) {});
  // Or its stances tell that the spring is not the one of the parameters.
  CHECK((unmoved.fault == Fault::none || unmoved.fault == Fault::parameters_implausible));
  // It sways with the torque's own period, and leaves the ground by 2 cm at most.
  CHECK(unmoved.last_apex_m < kTouchdownM + 0.025);
  check_safe(unmoved);
}

TEST_CASE(
    "another motor's drive is told by its velocity where its range is another, else by what the robot does") {
  struct Case {
    bus::Motor motor;
    Fault fault;       ///< none: hops on
    double highest_m;  ///< at most
    double toe_mps;    ///< at most
  };
  // mini_cheetah and AK60-6 are within the tolerance of a quarter: velocity 65 and 45 in place of 50 rad/s,
  // torque 18 and 15 in place of 18 N m.
  const Case c = GENERATE(Case{bus::Motor::mini_cheetah, Fault::none, 0.38, 2.0},
                          Case{bus::Motor::ak60_6, Fault::none, 0.38, 2.0},
                          Case{bus::Motor::ak70_10, Fault::none, 0.43, 2.0},
                          Case{bus::Motor::ak80_6, Fault::drive_mismatch, 0.38, 2.0},
                          Case{bus::Motor::ak80_64, Fault::drive_mismatch, 0.38, 5.0});
  const Outcome out = hop_with(RigFault::drive_of_other_motor, 0.001, 20.0, clutch_scenario(20.0),
                               [&](auto& rig) { rig.other_motor = c.motor; });
  INFO(bus::info(c.motor).name << ": " << control::info(out.fault).name << " after " << out.found_s);
  CHECK(out.fault == c.fault);
  if (c.fault != Fault::none) CHECK(out.found_s < 1.0);
  CHECK(out.highest_m < c.highest_m);
  CHECK(out.toe_mps < c.toe_mps);
  CHECK(out.hardest_mps < 3.0);
}

TEST_CASE(
    "the drive of an AK10-9, with 3.6 times the torque and the same velocity, is held by the envelope alone") {
  const Outcome out = hop_with(RigFault::drive_of_other_motor, 0.001, 8.0, clutch_scenario(8.0),
                               [](auto& rig) { rig.other_motor = bus::Motor::ak10_9; });
  CHECK(out.highest_m < 0.75);
  CHECK(out.hardest_mps < 3.0);
  // Beyond the 4 m/s of docs/safety.md, as the page says.
  CHECK(out.toe_mps < 4.3);
  CHECK(out.lowest_m > 0.10);
}
