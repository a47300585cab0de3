// A gait of the planar leg on the board's controller: sensors in whole counts, uneven ground, a late switch, what breaks.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

#include "host/gait/disturbed.hpp"
#include "host/gait/gait_table.hpp"
#include "host/gait/leg_faults.hpp"
#include "host/gait/stability.hpp"
#include "tests/host/gait/legs.hpp"

using namespace furcula;
using gait::Disturbed;
using gait::DisturbedOptions;

namespace {

const gait::Gait& hop(gait::LegSpring spring) {
  static std::map<gait::LegSpring, gait::Search> found;
  auto& s = found[spring];
  if (!s.gait) s = test::found(spring, test::in_place(0.075));
  return *s.gait;
}

}  // namespace

TEST_CASE("a gait's table gives the angles and torques of its stride") {
  const gait::Gait& g = hop(gait::LegSpring::switched);
  const control::GaitConfig c = gait::controller_config(g, gait::kStanceGains);
  CHECK(control::check(c) == Status::ok);
  double stance = -1.0, worst_angle = 0.0, worst_torque = 0.0;
  for (const gait::Moment& m : gait::moments_of(g)) {
    if (m.phase != gait::LegPhase::stance) continue;
    if (stance < 0.0) stance = m.time_s;
    const auto t = static_cast<float>(m.time_s - stance);
    worst_angle = std::max(worst_angle, std::abs(control::motion_at(c.stance, t).angle.knee - m.angle.knee));
    worst_torque = std::max(worst_torque, std::abs(control::torque_at(c.stance, t).hip - m.torque.hip));
  }
  CHECK(worst_angle < 1e-4);
  CHECK(worst_torque < 2.0);  // the last 8 ms of a stance change it by 5 N m
}

TEST_CASE("on level ground the board hops as the gait does") {
  const gait::Gait& g = hop(gait::LegSpring::switched);
  DisturbedOptions level;
  level.strides = 50;
  level.ground_m = 0.0;
  for (const double late : {0.0, 5e-3}) {
    level.switch_late_s = late;
    const Disturbed run = gait::run_disturbed(g, gait::kStanceGains, level);
    CHECK(run.falls == 0);
    CHECK(run.apex_spread_m < 1e-3);
    // Ticks, counts and the impact's tick cost something.
    CHECK(run.cost_j == Approx(gait::evaluate(g, false).cost_j).epsilon(0.3));
  }
}

TEST_CASE(
    "on ground within 1 cm and with a switch 5 ms late it does not fall in 1,000 strides, without the feedback it does") {
  for (const auto spring : {gait::LegSpring::switched, gait::LegSpring::parallel}) {
    const gait::Gait& g = hop(spring);
    for (const std::uint64_t seed : {1u, 2u}) {
      DisturbedOptions o;
      o.seed = seed;
      const Disturbed with = gait::run_disturbed(g, gait::kStanceGains, o);
      CHECK(with.strides == 1000);
      CHECK(with.falls == 0);
      // Ground that lies evenly within 1 cm has a deviation of 1 / sqrt(3) cm: the apex follows it, no further.
      CHECK(with.apex_spread_m < 0.0058);
    }
    CHECK(gait::run_disturbed(g, {}).falls > 100);
  }
}

TEST_CASE("what breaks in a leg's rig brings the safe state, in the time that is allowed") {
  for (const gait::LegFaultRow& row : gait::leg_fault_rows())
    for (const double at_s : gait::kLegFaultTimes_s) {
      const gait::LegTrial t = gait::try_leg_fault(hop(gait::LegSpring::switched), row.breaks, at_s);
      INFO(row.name << " at " << at_s << ": found " << control::info(t.found).name << " after "
                    << t.after_ticks);
      CHECK(std::find(row.finds.begin(), row.finds.end(), t.found) != row.finds.end());
      CHECK(t.after_ticks <= row.within_ticks);
      CHECK(t.torque_after_nm == 0.0);
    }
}
