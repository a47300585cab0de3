// The biped on the board's controller, with sensors that err: it walks, no fault is found where nothing is broken, what breaks is found
// in time, and who falls does not thrash.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <limits>

#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/walker_faults.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;
using control::Fault;
using control::WalkerStage;

namespace {

WalkerRigConfig rig_of(const char* mode, std::optional<std::uint64_t> seed) {
  const Walk found = test::found_walk(mode);
  return {.robot = dynamics::biped::design(), .mode = found.mode, .walk = found.parameters, .seed = seed};
}

/// Told to walk, until it does.
struct Walking {
  WalkerRigConfig config;
  WalkerRig rig;
  control::WalkerConfig board;
  control::WalkerState state;
  control::WalkerOutputs told;

  explicit Walking(const WalkerRigConfig& c)
      : config(c), rig(c), board(walker_config(c, 5.0)), state(control::begin_walker(board)) {}
  void tick(bool run = true, bool reset = false) {
    control::WalkerInputs in = rig.sense();
    in.run = run;
    in.reset = reset;
    told = control::step_walker(board, state, in, 1e-3f);
    rig.advance(told);
  }
};

}  // namespace

TEST_CASE("10 s of walking with sensors that err: stands, without a false alarm") {
  for (const char* mode : {"active", "semi_passive"})
    for (std::uint64_t seed = 0; seed <= 16; ++seed) {
      // 0: sensors that do not err, whose numbers repeat themselves.
      Walking w(rig_of(mode, seed > 0 ? std::optional(seed) : std::nullopt));
      INFO(mode << ", seed " << seed);
      while (w.rig.time_s() < 10.2 && w.told.fault == Fault::none) {
        // An IMU that repeats itself to the last bit is broken: without noise it does so on the stand.
        if (seed == 0) w.state.supervisor.imu_same = 0;
        w.tick();
      }
      CHECK(w.told.fault == Fault::none);
      CHECK(w.told.stage == WalkerStage::walking);
      CHECK(w.told.phase == control::WalkPhase::stop);
      CHECK(w.rig.state().position_m.z > 0.9);
      CHECK(w.rig.state().position_m.x > 0.5);
    }
}

TEST_CASE(
    "an exercise on the stand moves the legs as far as it says, without a false alarm, and a fault ends it") {
  for (const char* mode : {"active", "semi_passive"})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      WalkerRigConfig config = rig_of(mode, seed);
      Walking w(config);
      w.board.exercise_s = 10.0f;
      INFO(mode << ", seed " << seed);
      float least_rad = 10.0f, most_rad = -10.0f;
      while (w.rig.time_s() < 11.0 && w.told.fault == Fault::none) {
        w.tick();
        if (w.told.stage != WalkerStage::exercising) continue;
        const float knee_rad = w.state.last.joints[dynamics::biped::kKnee].angle_rad;
        least_rad = std::min(least_rad, knee_rad), most_rad = std::max(most_rad, knee_rad);
      }
      CHECK(w.told.fault == Fault::none);
      CHECK(w.told.stage == WalkerStage::exercising);
      CHECK(most_rad - least_rad > 0.25f);
      CHECK(w.rig.state().v_mps.z == 0.0);

      // A foot on the ground is not on the stand.
      for (const auto& [breaks, found] :
           {std::pair{WalkerFault::drive_silent, Fault::drive_silent},
            std::pair{WalkerFault::foot_stuck_on, Fault::contact_implausible}}) {
        config.fault = breaks;
        config.fault_s = 5.0;
        Walking broken(config);
        broken.board.exercise_s = 10.0f;
        while (broken.rig.time_s() < 6.0 && broken.told.fault == Fault::none) broken.tick();
        CHECK(broken.told.fault == found);
        CHECK(broken.told.stage == WalkerStage::damped);
      }
    }
}

TEST_CASE(
    "a bus a leg at 500 Hz does for the walk: no false alarm, and a dead drive is found two answers later") {
  for (const char* mode : {"active", "semi_passive"})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      WalkerRigConfig config = rig_of(mode, seed);
      config.two_buses = true;
      Walking w(config);
      INFO(mode << ", seed " << seed);
      while (w.rig.time_s() < 10.2 && w.told.fault == Fault::none) w.tick();
      CHECK(w.told.fault == Fault::none);
      CHECK(w.rig.state().position_m.z > 0.9);
      config.fault = WalkerFault::drive_silent;
      config.fault_s = 2.0 + 0.001 * static_cast<double>(seed);
      const WalkerTrial t = try_walker_fault(config);
      CHECK(t.found == Fault::drive_silent);
      CHECK(t.after_ticks <= 3);
    }
}

TEST_CASE("what the board commands is what the walk and the attitude filter say by themselves") {
  using namespace dynamics::biped;
  Walking w(rig_of("active", 3));
  while (w.told.stage != WalkerStage::walking && w.rig.time_s() < 1.0) w.tick();
  control::AttitudeFilter<float> filter = w.state.filter;
  control::WalkState<float> walk = control::begin_walk(w.board.walk);
  std::array<control::FootSwitch<float>, 2> feet{{{1.0f, 0.0f}, {1.0f, 0.0f}}};
  std::size_t differing = 0;
  for (int i = 0; i < 4000; ++i) {
    const control::WalkerSample seen = w.rig.sense().sample;
    // Seen twice, the sensors' next errors are others: the board gets this sample.
    w.told = control::step_walker(w.board, w.state, {seen, false, true, 1000}, 1e-3f);
    w.rig.advance(w.told);
    control::WalkSample<float> sample;
    for (std::size_t j = 0; j < kJoints; ++j) {
      set_joint<float>(sample.q_rad, j, seen.joints[j].angle_rad);
      set_joint<float>(sample.qd_radps, j, seen.joints[j].rate_radps);
    }
    for (std::size_t side = 0; side < 2; ++side) feet[side].step(seen.foot_n[side], 30.0f, 1e-3f);
    sample.gyro_radps = seen.gyro_radps;
    sample.attitude = filter.attitude;
    sample.left_carries = feet[0].carries;
    sample.right_carries = feet[1].carries;
    control::step_attitude(control::AttitudeGains<float>{}, {seen.gyro_radps, seen.acc_mps2}, 1e-3f, filter);
    control::WalkOutputs<float> out;
    control::step_walk(w.board.walk, sample, 1e-3f, walk, out);
    for (std::size_t j = 0; j < kJoints; ++j)
      if (std::bit_cast<std::uint32_t>(joint<float>(out.target_rad, j)) !=
          std::bit_cast<std::uint32_t>(w.told.joints[j].target_rad))
        ++differing;
  }
  CHECK(w.told.fault == Fault::none);
  CHECK(differing == 0);
}

TEST_CASE(
    "what breaks in a walking robot is found in the time that is allowed, its drives only brake, within a limit") {
  for (const WalkerFaultRow& row : walker_fault_rows())
    for (const WalkerRigConfig& config : trials_of(row, rig_of("active", {}))) {
      const WalkerTrial t = try_walker_fault(config);
      INFO(row.name << " at " << config.fault_s << " s, joint " << config.joint << ": found "
                    << control::info(t.found).name << " after " << t.after_ticks << ", joint " << t.suspect);
      CHECK(std::find(row.finds.begin(), row.finds.end(), t.found) != row.finds.end());
      CHECK(t.after_ticks <= row.within_ticks);
      if (row.joints.size() > 1) CHECK(t.suspect == config.joint);
      CHECK(t.work_after_j == 0.0);
      // The limit holds for the rate of a tick's beginning.
      CHECK(t.torque_after_nm < 1.1 * 80.0);
    }
}

TEST_CASE("the walk of docs/safety.md is that of active_walk.toml") {
  CHECK(tried_walk().values() == test::found_walk().parameters.values());
}

TEST_CASE("a robot that is pushed over thrashes without its supervisor") {
  WalkerRigConfig config = rig_of("active", 1);
  config.fault = WalkerFault::pushed;
  config.fault_s = kWalkerFaultTimes_s[0];
  const WalkerTrial falls = try_walker_fault(config), thrashes = try_walker_fault(config, false);
  CHECK(thrashes.found == Fault::none);
  CHECK(thrashes.torque_after_nm == Approx(220.0));
  CHECK(thrashes.work_after_j > 50.0);
  CHECK(falls.work_after_j == 0.0);
  CHECK(falls.speed_after_radps < thrashes.speed_after_radps);
}

TEST_CASE(
    "a fault stays until a reset, and a robot that is still told to walk does not begin again by that") {
  WalkerRigConfig config = rig_of("active", 1);
  config.fault = WalkerFault::encoder_jumping;
  config.fault_s = 1.0;
  Walking w(config);
  while (w.told.fault == Fault::none && w.rig.time_s() < 2.0) w.tick();
  REQUIRE(w.told.fault == Fault::encoder_jump);
  for (int i = 0; i < 50; ++i) w.tick();
  CHECK(w.told.fault == Fault::encoder_jump);
  CHECK(w.told.stage == WalkerStage::damped);
  for (std::size_t j = 0; j < control::kWalkerJoints; ++j) {
    CHECK(w.told.joints[j].stiffness_nmprad == 0.0f);
    CHECK((w.told.joints[j].damping_nmsprad == 0.0f) == (j == config.joint));
  }
  w.tick(true, true);
  CHECK(w.told.fault == Fault::none);
  CHECK(w.told.stage == WalkerStage::idle);
  for (const auto& joint : w.told.joints) CHECK(joint.damping_nmsprad == 0.0f);
  w.tick(false);
  w.tick(true);
  CHECK(w.told.stage == WalkerStage::joining);
}

TEST_CASE("a walk with numbers that are none, and a state that nobody began, are not walked") {
  const WalkerRigConfig rig = rig_of("active", 1);
  const control::WalkerConfig good = walker_config(rig, 5.0);
  CHECK(control::check(good) == Status::ok);
  // What is divided by.
  using Supervisor = control::WalkSupervisorConfig;
  for (float Supervisor::*fades :
       {&Supervisor::slip_fades_s, &Supervisor::torque_fades_s, &Supervisor::weight_fades_s,
        &Supervisor::turn_fades_s, &Supervisor::vertical_fades_s}) {
    control::WalkerConfig zero = good;
    zero.supervisor.*fades = 0.0f;
    CHECK(control::check(zero) == Status::invalid);
  }
  control::WalkerConfig bad = good;
  bad.walk.walk.knee_rad = std::numeric_limits<float>::quiet_NaN();
  CHECK(control::check(bad) == Status::invalid);
  bad = good;
  bad.walk.walk.up_blend_s = 0.0f;
  CHECK(control::check(bad) == Status::invalid);
  bad = good;
  bad.walk.body.drives[1][2].kp_nmprad = 0.0f;
  CHECK(control::check(bad) == Status::invalid);
  for (auto state : {control::begin_walker(bad), control::WalkerState{}}) {
    const auto out = control::step_walker(good, state, WalkerRig(rig).sense(), 1e-3f);
    CHECK(out.fault == Fault::bad_configuration);
    for (const auto& joint : out.joints) CHECK(joint.stiffness_nmprad == 0.0f);
  }
}
