// A gait of the planar leg on the board's controller: sensors in whole counts, uneven ground, a late switch, what breaks.
#include <catch2/catch.hpp>
#include <map>

#include "boards/sim_host/leg_rig.hpp"
#include "host/gait/disturbed.hpp"
#include "host/gait/gait_table.hpp"
#include "host/gait/stability.hpp"
#include "tests/host/gait/legs.hpp"

using namespace furcula;
using control::Fault;
using gait::Disturbed;
using gait::DisturbedOptions;
using sim_host::LegFault;
using sim_host::LegRig;

namespace {

const gait::Gait& hop(gait::LegSpring spring) {
  static std::map<gait::LegSpring, gait::Search> found;
  auto& s = found[spring];
  if (!s.gait) s = test::found(spring, test::in_place(0.075));
  return *s.gait;
}

struct Found {
  Fault fault = Fault::none;
  double after_s = 0.0;
};
Found found_of(LegFault breaks, double at_s) {
  const gait::Gait& g = hop(gait::LegSpring::switched);
  const control::GaitConfig config = gait::controller_config(g, gait::kStanceGains);
  LegRig rig({g.machine.leg, g.machine.spring, g.task.lift_off, 0.01, 5e-3, true, 1, breaks, at_s});
  const auto apex = gait::apex_of(g);
  rig.drop(apex.height, apex.speed, apex.angle);
  control::GaitState state = control::begin_gait(config);
  while (rig.time_s() < at_s + 3.0) {
    const auto out = control::step_gait(config, state, rig.sense(), 1e-3f);
    if (out.fault != Fault::none) return {out.fault, rig.time_s() - at_s};
    rig.advance(out.torque_nm);
  }
  return {Fault::none, 3.0};
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
    "on ground within 1 cm and with a switch 5 ms late it does not fall in 1,000 strides; without the feedback it does") {
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
  struct Row {
    LegFault breaks;
    std::vector<Fault> as;
    double within_s;
  };
  for (const Row& row :
       {Row{LegFault::height_nan, {Fault::non_finite_input}, 0.0},
        Row{LegFault::height_jumps, {Fault::encoder_jump}, 0.0},
        Row{LegFault::sample_stale, {Fault::stale_input}, 0.002},
        Row{LegFault::sample_missing, {Fault::peer_lost}, 0.002},
        Row{LegFault::height_stuck, {Fault::encoder_implausible, Fault::contact_implausible}, 0.6},
        Row{LegFault::switch_stuck_closed, {Fault::contact_implausible, Fault::encoder_implausible}, 0.6},
        Row{LegFault::knee_stuck,
            {Fault::encoder_implausible, Fault::leg_astray, Fault::height_out_of_range,
             Fault::contact_implausible, Fault::leg_angle_out_of_range},
            1.5},
        Row{LegFault::knee_drive_off,
            {Fault::leg_astray, Fault::height_out_of_range, Fault::leg_angle_out_of_range,
             Fault::encoder_implausible, Fault::encoder_jump, Fault::contact_implausible},
            3.0}})
    // In flight, and at two moments of a stance.
    for (const double at_s : {2.00, 2.15, 2.30, 2.45}) {
      const Found f = found_of(row.breaks, at_s);
      INFO("fault " << static_cast<int>(row.breaks) << " at " << at_s << ": found "
                    << static_cast<int>(f.fault) << " after " << f.after_s);
      CHECK(std::find(row.as.begin(), row.as.end(), f.fault) != row.as.end());
      CHECK(f.after_s <= row.within_s + 1.001e-3);  // the tick on which it is sensed
    }
}
