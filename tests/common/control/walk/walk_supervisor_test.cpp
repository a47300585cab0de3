// What the supervisor makes of drives on buses: torques of older targets, angles in steps. The rest is in tests/sil/walker_test.cpp.
#include "furcula/control/walk/walk_supervisor.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula;
using namespace furcula::control;

namespace {

constexpr float kTick_s = 1e-3f, kStiffness_nmprad = 3000.0f;
constexpr std::size_t kJoint = 3;

/// A joint whose target moves by 1 rad/s there and back, 20 mrad behind it, so that its drive gives 60 N m: of the target told
/// `older` ticks before the last one.
struct Joint {
  explicit Joint(const WalkSupervisorConfig& c) : config(c) {
    sample.answered = kAllDevices;
    sample.acc_mps2 = {0.0f, 0.0f, 9.81f};
    state.heard = kAllDevices;
  }
  static float target_rad(int tick) {
    const int in_turn = tick % 400;
    return 1e-3f * static_cast<float>(in_turn < 200 ? in_turn : 400 - in_turn);
  }
  Fault tick(int older, float share = 1.0f) {
    JointReading& r = sample.joints[kJoint];
    const float before_rad = r.angle_rad;
    r.angle_rad = target_rad(now) - 0.02f;
    r.rate_radps = now == 0 ? 0.0f : (r.angle_rad - before_rad) / kTick_s;
    if (now == 0) state.before_rad[kJoint] = r.angle_rad;
    const int told_at = now - 1 - older;
    r.torque_nm = share * kStiffness_nmprad * (target_rad(told_at > 0 ? told_at : 0) - r.angle_rad);
    sample.gyro_radps.x = 1e-3f * static_cast<float>(now % 2);  // it lives
    WalkObservation seen{sample};
    seen.driven = seen.on_stand = true;
    const Fault found = supervise_walk(config, state, seen, false, kTick_s);
    std::array<JointCommand, kWalkerJoints> told{};
    told[kJoint] = {target_rad(now), kStiffness_nmprad, 0.0f};
    note_told(config, state, told);
    ++now;
    return found;
  }
  /// @returns the first fault within 350 ticks.
  Fault run(int older, float share = 1.0f) {
    Fault found = Fault::none;
    while (now < 350 && found == Fault::none) found = tick(older, share);
    return found;
  }

  WalkSupervisorConfig config;
  WalkSupervisorState state;
  WalkerSample sample;
  int now = 0;
};

WalkSupervisorConfig lagging(std::uint32_t ticks) {
  WalkSupervisorConfig c;
  c.torque_lag_ticks = ticks;
  c.torque_off_nm = 2.0f;
  c.pins_max_s = 1e9f;
  return c;
}

}  // namespace

TEST_CASE("a drive's torque is held against the target that it was told when it answered") {
  // A tick of the target's way is 3 N m: two ticks off are 6 N m on the way there and back, over the limit of 2 here.
  for (const std::uint32_t lag : {0u, 1u, 2u, 12u, kTorqueLagMost}) {
    INFO(lag);
    CHECK(Joint(lagging(lag)).run(static_cast<int>(lag)) == Fault::none);
    CHECK(Joint(lagging(lag)).run(lag >= 2 ? static_cast<int>(lag) - 2 : 2) == Fault::drive_disobeys);
    CHECK(Joint(lagging(lag)).run(static_cast<int>(lag), 0.0f) == Fault::drive_disobeys);
  }
}

TEST_CASE("an angle that is read again by chance is none that stands still, before it is so for long") {
  WalkSupervisorConfig c;
  c.pins_max_s = 1e9f;
  c.astray_rad = 10.0f;
  c.torque_off_nm = 1e9f;
  Joint joint(c);
  for (int i = 0; i < 50; ++i) REQUIRE(joint.tick(0) == Fault::none);
  // Its target jumps by 50 mrad, the reading stays.
  joint.sample.joints[kJoint].rate_radps = 0.0f;
  int ticks = 0;
  Fault found = Fault::none;
  for (; ticks < 50 && found == Fault::none; ++ticks) {
    joint.sample.gyro_radps.x = 1e-3f * static_cast<float>(ticks % 2);
    WalkObservation seen{joint.sample};
    seen.driven = seen.on_stand = true;
    std::array<JointCommand, kWalkerJoints> told{};
    told[kJoint] = {Joint::target_rad(50) + 0.05f, kStiffness_nmprad, 0.0f};
    found = supervise_walk(c, joint.state, seen, false, kTick_s);
    note_told(c, joint.state, told);
  }
  CHECK(found == Fault::encoder_implausible);
  // Longer than 10 ms, in which 45 N m move a rotor of 1.28 kg m^2 by 1.7 mrad; ten ticks may add up to a little more than that.
  CHECK(ticks >= 10);
  CHECK(ticks <= 11);
}
