// Touch-down and lift-off told without the switch, on the simulated robot, and what the robot does that loses
// its switch.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

#include "boards/sim_host/can_board.hpp"
#include "firmware/app/app.hpp"
#include "host/core/random.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;
using core::Random;
using sim_host::CanBoard;
using sim_host::RigFault;
using sim_host::SimBoard;

namespace {

SimBoard& rig_of(SimBoard& board) { return board; }
SimBoard& rig_of(CanBoard& board) { return board.rig(); }

/// A change of contact, as it was or as it was told.
struct Change {
  bool touchdown;
  double time_s;
};

struct Told {
  std::vector<double> touchdown_ms, liftoff_ms;  ///< late by so much, early below zero
  int touchdowns = 0, liftoffs = 0;              ///< that there were
  int missed = 0, wrong = 0;

  void add(const Told& more) {
    touchdown_ms.insert(touchdown_ms.end(), more.touchdown_ms.begin(), more.touchdown_ms.end());
    liftoff_ms.insert(liftoff_ms.end(), more.liftoff_ms.begin(), more.liftoff_ms.end());
    touchdowns += more.touchdowns;
    liftoffs += more.liftoffs;
    missed += more.missed;
    wrong += more.wrong;
  }
};

constexpr double kNear_s = 0.030;
/// A toe that the motor makes hover so low, for a moment, has not left the ground.
constexpr double kHover_m = 0.002, kHover_s = 0.030;

/// Each true change with the nearest telling of its kind; what is left over is wrong.
Told compare(const std::vector<Change>& truth, std::vector<Change> told) {
  Told out;
  for (const Change& t : truth) {
    ++(t.touchdown ? out.touchdowns : out.liftoffs);
    const auto off_s = [&](const Change& c) { return std::abs(c.time_s - t.time_s); };
    auto best = told.end();
    for (auto it = told.begin(); it != told.end(); ++it)
      if (it->touchdown == t.touchdown && off_s(*it) < kNear_s &&
          (best == told.end() || off_s(*it) < off_s(*best)))
        best = it;
    if (best == told.end()) {
      ++out.missed;
      continue;
    }
    (t.touchdown ? out.touchdown_ms : out.liftoff_ms).push_back(1e3 * (best->time_s - t.time_s));
    told.erase(best);
  }
  out.wrong = static_cast<int>(told.size());
  return out;
}

/// What a run came to by the observer, and by the switch, freed from bounce.
struct Run {
  Told observer, by_switch;
  bool faulty = false;
};

template <class Board>
Run run_on(Board board, const control::Config& config) {
  firmware::App app(board, config);
  const SimBoard& rig = rig_of(board);
  std::vector<Change> truth, observed, switched;
  bool contact = false, closed = false, faulty = false;
  double ground_m = 0.0, highest_m = 1.0;
  while (board.wait_for_tick()) {
    const double now_s = rig.time_s(), toe_m = rig.plant().toe_height_m();
    for (const auto& event : rig.plant().events()) {
      const double time_s = now_s - SimBoard::kPeriodS + event.offset_s;
      const bool touchdown = event.kind == dynamics::ContactEvent<double>::Kind::touchdown;
      if (touchdown && !truth.empty() && highest_m < kHover_m && time_s - truth.back().time_s < kHover_s)
        truth.pop_back();
      else
        truth.push_back({touchdown, time_s});
      ground_m = toe_m;
      highest_m = 0.0;
    }
    highest_m = std::max(highest_m, toe_m - ground_m);
    app.tick();
    const auto& out = rig.telemetry().outputs;
    if (out.contact.contact != contact) observed.push_back({contact = !contact, now_s});
    if (app.state().debounce.closed != closed) switched.push_back({closed = !closed, now_s});
    faulty = faulty || out.fault != control::Fault::none || out.landing;
  }
  return {compare(truth, observed), compare(truth, switched), faulty};
}

struct Errors {
  double median, of_95, worst;
};
Errors errors(std::vector<double> ms) {
  REQUIRE_FALSE(ms.empty());
  for (double& v : ms) v = std::abs(v);
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double share) {
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  };
  return {at(0.5), at(0.95), at(1.0)};
}
void print(const char* name, const Told& t) {
  for (const bool touchdown : {true, false}) {
    const auto& ms = touchdown ? t.touchdown_ms : t.liftoff_ms;
    const Errors e = errors(ms);
    std::printf("%-9s %-10s %5zu of %5d told; error %5.2f ms median, %5.2f 95 %%, %5.2f worst\n", name,
                touchdown ? "touch-down" : "lift-off", ms.size(), touchdown ? t.touchdowns : t.liftoffs,
                e.median, e.of_95, e.worst);
  }
  std::printf("%-9s %d missed, %d told that were none\n", name, t.missed, t.wrong);
}

/// The robot is other than its controller thinks: by how much, at most.
constexpr double kMass = 0.10, kStiffness = 0.05, kRest_m = 0.002, kLegDamping = 0.30, kGuideDamping = 0.50,
                 kLink = 0.01, kInertia = 0.10, kTorque = 0.05;

model::Model drawn_robot(Random& random) {
  const auto within = [&](double share) { return 1.0 + random.uniform(-share, share); };
  model::Model real = robot_with_clutch();
  real.parameters[0] *= within(kMass);
  real.parameters[1] *= within(kStiffness);
  real.parameters[2] += random.uniform(-kRest_m, kRest_m);
  real.parameters[3] *= within(kLegDamping);
  real.parameters[4] *= within(kGuideDamping);
  real.parameters[7] *= within(kLink);
  for (std::size_t k = 10; k < 13; ++k) real.parameters[k] *= within(kInertia);
  real.effects[dynamics::Effect::torque_gain_error] = {within(kTorque)};
  return real;
}

Run drawn_run(std::uint64_t number) {
  Random random(11, number);
  const model::Model real = drawn_robot(random);
  sim::Scenario scenario = clutch_scenario(10.0);
  scenario.start_position = random.uniform(0.30, 0.38);
  scenario.amplitude = random.uniform(2.0, 4.0);
  scenario.period_s = random.uniform(0.27, 0.33);
  scenario.release_in_flight = number % 3 != 0;
  scenario.contraction_m = number % 3 != 0 ? random.uniform(0.0, 0.08) : 0.0;
  scenario.ground_steps_m = number % 2 != 0 ? 0.03 : 0.0;
  scenario.sensors = {true, true, true, true};
  const auto rig = sim::rig_config(real, scenario, number);
  control::Config config = sim::controller_config(robot_with_clutch(), scenario);
  if (number % 4 == 0) return run_on(SimBoard(rig), config);
  CanBoard::adapt(config);
  return run_on(CanBoard(rig), config);
}

}  // namespace

TEST_CASE(
    "of 1,000 varied hops of robots that are not quite as configured the observer tells touch-down and lift-off "
    "better than the switch") {
  Told observer, by_switch;
  int faulty = 0;
  for (std::uint64_t number = 0; observer.touchdowns < 1000; ++number) {
    const Run run = drawn_run(number);
    faulty += run.faulty ? 1 : 0;
    observer.add(run.observer);
    by_switch.add(run.by_switch);
  }
  print("observer", observer);
  print("switch", by_switch);
  CHECK(faulty == 0);
  // An impact shows in the sample after it, on a bus in the one after that.
  const Errors touchdown = errors(observer.touchdown_ms);
  CHECK(touchdown.median < 2.0);
  CHECK(touchdown.of_95 < 3.0);
  CHECK(touchdown.worst < 12.0);
  // The force fades slowly, and a spring that is 5 % off is half a newton.
  const Errors liftoff = errors(observer.liftoff_ms);
  CHECK(liftoff.median < 2.0);
  CHECK(liftoff.of_95 < 8.0);
  CHECK(liftoff.worst < 20.0);
  CHECK(observer.missed <= 0.005 * (observer.touchdowns + observer.liftoffs));
  CHECK(observer.wrong <= 0.02 * (observer.touchdowns + observer.liftoffs));
  CHECK(touchdown.of_95 < 0.3 * errors(by_switch.touchdown_ms).of_95);
  CHECK(liftoff.of_95 < 0.7 * errors(by_switch.liftoff_ms).of_95);
}

namespace {

/// A robot that loses its switch at an instant, four seconds long.
struct Lost {
  control::Fault fault = control::Fault::none;
  bool lands = false;
  double lowest_m = 1.0, most_power_w = -1e9, still_s = 0.0;
  std::uint32_t releases_while_landing = 0;
};

Lost lose(RigFault kind, double at_s, std::uint64_t seed) {
  sim::Scenario scenario = clutch_scenario(at_s + 4.0);
  scenario.sensors = {true, true, true, true};
  scenario.faults = {{at_s, kind, 100.0}};
  Random random(13, seed);
  SimBoard board(sim::rig_config(drawn_robot(random), scenario, seed));
  firmware::App app(board, sim::controller_config(robot_with_clutch(), scenario));
  Lost out;
  bool coil = false;
  double angle_rad = 0.0, torque_nm = 0.0;
  while (board.wait_for_tick()) {
    const double rate_radps = (board.plant().leg_angle_rad() - angle_rad) / SimBoard::kPeriodS;
    angle_rad = board.plant().leg_angle_rad();
    const auto before = board.telemetry().outputs;
    app.tick();
    const auto& o = board.telemetry().outputs;
    // What the motor did to the leg on the ground since the last tick.
    if (before.landing && before.phase.phase == control::Phase::stance && !before.clutch.drives_leg)
      out.most_power_w = std::max(out.most_power_w, torque_nm * rate_radps);
    torque_nm = static_cast<double>(o.command.torque_nm);
    if (o.landing && !coil && o.clutch.coil) ++out.releases_while_landing;
    coil = o.clutch.coil;
    out.lands = out.lands || o.landing;
    if (out.fault == control::Fault::none) out.fault = o.fault;
    if (board.time_s() < at_s) continue;
    out.lowest_m = std::min(out.lowest_m, board.plant().height_m());
    if (std::abs(board.plant().velocity_mps()) > 0.05) out.still_s = board.time_s() - at_s;
  }
  return out;
}

}  // namespace

TEST_CASE("a robot that loses its switch lands with a brake on its leg and stands still within a second") {
  const RigFault kind = GENERATE(RigFault::switch_stuck_open, RigFault::switch_stuck_closed);
  int n = 0;
  for (double at_s = 2.0; at_s < 2.5; at_s += 0.031) {
    const Lost lost = lose(kind, at_s, static_cast<std::uint64_t>(++n));
    CAPTURE(at_s, lost.lowest_m, lost.still_s);
    CHECK(lost.lands);
    CHECK(lost.fault == control::Fault::contact_switch_lost);
    CHECK(lost.lowest_m > 0.17);
    CHECK(lost.still_s < 1.0);
    CHECK(lost.releases_while_landing == 0);
    // A brake takes power. As the spring is caught off its home, the motor gives back what that lacks; and the
    // brake knows the rate of a millisecond ago.
    CHECK(lost.most_power_w < 2.0);
  }
}

TEST_CASE("a height encoder that breaks is never taken for a switch that is lost") {
  const RigFault kind = GENERATE(RigFault::encoder_stuck, RigFault::encoder_reversed,
                                 RigFault::encoder_backwards, RigFault::encoder_jumping);
  int n = 0;
  for (double at_s = 2.0; at_s < 2.5; at_s += 0.023) {
    const Lost lost = lose(kind, at_s, static_cast<std::uint64_t>(++n));
    CAPTURE(static_cast<int>(kind), at_s, static_cast<int>(lost.fault));
    CHECK_FALSE(lost.lands);
    CHECK(lost.fault != control::Fault::none);
    CHECK(lost.fault != control::Fault::contact_switch_lost);
  }
}

TEST_CASE("a robot whose switch is lost stands, and a reset does not let it hop with it") {
  sim::Scenario scenario = clutch_scenario(8.0);
  scenario.sensors = {true, true, true, true};
  scenario.faults = {{2.2, RigFault::switch_stuck_open, 100.0}};
  SimBoard board(sim::rig_config(robot_with_clutch(), scenario, 1));
  firmware::App app(board, sim::controller_config(robot_with_clutch(), scenario));
  double highest_m = 0.0;
  bool lands = false;
  while (board.wait_for_tick()) {
    if (std::abs(board.time_s() - 5.0) < 1e-9) {
      CHECK(board.telemetry().outputs.fault == control::Fault::contact_switch_lost);
      board.request_reset();
    }
    app.tick();
    if (board.time_s() < 5.0) continue;
    lands = lands || board.telemetry().outputs.landing;
    highest_m = std::max(highest_m, board.plant().height_m());
  }
  CHECK(lands);
  CHECK(board.telemetry().outputs.fault == control::Fault::contact_switch_lost);
  CHECK(highest_m < kTouchdownM);
}
